"""A gateway that is always far behind: rows, and what is told while nothing comes."""

from backend.tracking.fold import IncidentFold
from estimator.measurements import Alarm
from estimator.trackers.base import TrackerSettings
from tests.backend.tracking.conftest import a_gateway_behind, entry, fold_all

SETTINGS = TrackerSettings()


def test_what_is_told_while_nothing_comes_is_in_no_row_of_a_second_that_is_over() -> None:
    batches, quiet, settled = a_gateway_behind(60), [], []
    undisturbed, interrupted = (IncidentFold("kirchhoff", SETTINGS) for _ in range(2))
    changed = 0
    for seq, readings in enumerate(batches, start=1):
        quiet += [row for row in undisturbed.fold(entry(seq), readings) if row is not None]
        settled += [row for row in interrupted.fold(entry(seq), readings) if row is not None]
        if seq % 20 == 0 and interrupted.settle():
            changed += 1
            assert not interrupted.settle()
            interrupted.last_row()
    assert settled == quiet
    assert changed >= 2


def test_while_nothing_comes_late_readings_are_told_as_if_they_had_come_in_time() -> None:
    batches = a_gateway_behind(60)
    late, in_time = (IncidentFold("kirchhoff", SETTINGS) for _ in range(2))
    fold_all(late, batches)
    fold_all(in_time, sorted(batches, key=lambda batch: batch[0].t))
    assert late.settle()
    assert late.picture() == in_time.picture()
    assert late.relative("ff1", "ff2") == in_time.relative("ff1", "ff2")


def test_a_call_that_comes_late_is_shown_at_once() -> None:
    fold = IncidentFold("kirchhoff", SETTINGS, live=True)
    fold_all(fold, a_gateway_behind(60))
    called = Alarm(t=1021.0, node="ff2", alarm="mayday", state="raised")
    fold_all(fold, [[called]], first=1000)
    assert [alarm.node for alarm in fold.picture().alarms] == ["ff2"]
