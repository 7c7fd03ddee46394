"""Which readings the estimator is given when a fix is to be explained."""

from collections.abc import Sequence

import pytest

from backend.errors import NotFound
from backend.log.incidents import IncidentStore
from backend.tracking.aside import advice_of_log, evidence_of_log
from backend.tracking.heads import Head, head_of
from estimator import trackers
from estimator.measurements import AnyReading, Position
from estimator.trackers.base import TrackerSettings
from tests.backend.tracking.conftest import Write


class Asked:
    """Stands in for the estimator and keeps what it was given."""

    def __init__(self) -> None:
        self.epochs: list[float] = []

    def __call__(
        self, tracker: str, settings: TrackerSettings, readings: Sequence[AnyReading], node: str
    ) -> None:
        assert (tracker, settings) == ("kirchhoff", TrackerSettings())
        self.epochs = [reading.t for reading in readings]
        if node != "ff1":
            raise KeyError(node)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> Asked:
    stand_in = Asked()
    for name in ("evidence", "advice"):
        monkeypatch.setattr(trackers, name, stand_in, raising=False)
    return stand_in


@pytest.fixture
def head(store: IncidentStore, write: Write) -> Head:
    """An incident whose third entry came late."""
    incident = store.create("late", "recorded")
    write(incident.id, [[fix(10.0)], [fix(12.0), fix(11.0)], [fix(9.0)], [fix(13.0)]])
    return head_of(store.get(incident.id))


def fix(t: float) -> Position:
    return Position(t=t, node="ff1", position_m=(0.0, 0.0, 0.0))


def test_without_a_moment_the_whole_log_counts(sqlite_url: str, head: Head, asked: Asked) -> None:
    assert evidence_of_log(sqlite_url, head, "ff1", None) is None
    assert asked.epochs == [10.0, 12.0, 11.0, 9.0, 13.0]
    assert advice_of_log(sqlite_url, head, "ff1") is None
    assert asked.epochs == [10.0, 12.0, 11.0, 9.0, 13.0]


def test_of_a_moment_epochs_up_to_it_count_whenever_they_came(
    sqlite_url: str, head: Head, asked: Asked
) -> None:
    evidence_of_log(sqlite_url, head, "ff1", 11.0)
    assert asked.epochs == [10.0, 11.0, 9.0]


def test_entries_after_the_head_are_left_out(sqlite_url: str, head: Head, write: Write, asked: Asked) -> None:
    write(head.incident, [[fix(14.0)]])
    evidence_of_log(sqlite_url, head, "ff1", None)
    assert max(asked.epochs) == 13.0


def test_a_node_that_nothing_has_named_is_not_found(sqlite_url: str, head: Head, asked: Asked) -> None:
    with pytest.raises(NotFound, match=r"has named 'ff9' up to t = 11\.000"):
        evidence_of_log(sqlite_url, head, "ff9", 11.0)
    with pytest.raises(NotFound, match="has named 'ff9' yet"):
        advice_of_log(sqlite_url, head, "ff9")
    assert asked.epochs
