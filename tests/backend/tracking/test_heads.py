"""The worker has to follow what is not folded yet, or was folded with what holds no longer."""

from typing import Any

import pytest
import sqlalchemy as sa

from backend.coordination.lease import Leases
from backend.log.base import Snapshot
from backend.log.derived import SqlDerivedWriter
from backend.log.engine import writing
from backend.log.incidents import IncidentStore
from backend.tracking.heads import head_of, heads, running
from estimator.measurements import Status
from tests.backend.tracking.conftest import Write


@pytest.fixture
def folded(engine: sa.Engine, store: IncidentStore, write: Write) -> str:
    """An incident whose snapshot holds its whole log."""
    incident = store.create("caught up", "recorded")
    write(incident.id, [[Status(t=1.0, node="ff1", battery=0.5)]])
    epoch = Leases(lambda: writing(engine), "north").acquire(incident.id)
    assert epoch is not None
    snapshot = Snapshot(seq=1, state=b"state", made_with=head_of(incident).made_with.encoded())
    SqlDerivedWriter(engine).save(incident.id, epoch, [], snapshot)
    return incident.id


@pytest.mark.parametrize(
    "change",
    [
        {"settings": {"tracker": "paper-a"}},
        {"settings": {"lag_s": 5.0}},
        {"origin": {"lat": 59.0, "lon": 18.0, "hae": 0.0}},
    ],
)
def test_an_incident_folded_with_other_settings_is_not_folded(
    engine: sa.Engine, store: IncidentStore, folded: str, change: dict[str, Any]
) -> None:
    assert heads(engine, []) == []
    changed = store.change(folded, change)
    assert heads(engine, []) == [head_of(changed)]


def test_a_name_and_an_end_leave_an_incident_folded(
    engine: sa.Engine, store: IncidentStore, folded: str
) -> None:
    store.change(folded, {"name": "renamed", "state": "closed"})
    assert heads(engine, []) == []


def test_whatever_was_set_is_noted_with_the_state(
    engine: sa.Engine, store: IncidentStore, folded: str
) -> None:
    changed = store.change(folded, {"settings": {"stale_after_s": 5.0}})
    assert heads(engine, []) == [head_of(changed)]


def test_settings_that_were_changed_back_are_folded_all_the_same(
    engine: sa.Engine, store: IncidentStore, folded: str
) -> None:
    store.change(folded, {"settings": {"tracker": "paper-a"}})
    changed = store.change(folded, {"settings": {"tracker": "kirchhoff"}})
    assert heads(engine, []) == [head_of(changed)]


def test_live_incidents_run_until_they_are_closed(engine: sa.Engine, store: IncidentStore) -> None:
    store.create("looked at again", "recorded")
    closed, first, second = (store.create(name, "live") for name in ("over", "north", "south"))
    store.change(closed.id, {"state": "closed"})
    assert running(engine) == [head_of(first), head_of(second)]
