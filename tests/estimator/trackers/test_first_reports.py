"""A unit that sums up seconds: what is heard of its bearer meanwhile waits for the first report as well."""

import numpy as np
import pytest

from estimator.measurements import AnyReading
from estimator.measurements.displacement import Awaited, Displacement
from estimator.measurements.node import Node
from estimator.measurements.rssi import Rssi
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.first_reports import FirstReports
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.trackers.entry import BASE, off_m, shown

ENTERS = Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.1)


def report(from_t: float, t: float) -> Displacement:
    """Of who walks east, a metre a second."""
    return Displacement(t=t, from_t=from_t, node="ff1", delta_m=(t - from_t, 0.0, 0.0))


def walk(period_s: int) -> list[AnyReading]:
    """Twice the time between two reports, the base heard each second."""
    told: list[AnyReading] = [BASE, ENTERS]
    for second in range(1, 2 * period_s + 1):
        told.append(Rssi(t=float(second), a="ff1", b="base", dbm=-40.0 - 25.0 * float(np.log10(second))))
        if second % period_s == 0:
            told.append(report(float(second - period_s), float(second)))
    return told


def tracked(readings: list[AnyReading]) -> KirchhoffTracker:
    tracker = KirchhoffTracker()
    for reading in readings:
        tracker.fold([reading])
        tracker.estimates()
    return tracker


@pytest.mark.parametrize("period_s", [2, 5, 8, 15])
def test_of_a_first_report_all_counts(period_s: int) -> None:
    """Were its bearer taken to have no unit until then, only its last second would."""
    readings = walk(period_s)
    first = readings[: 3 + period_s]
    assert off_m(shown(tracked(first)), (float(period_s), 0.0)) < 0.1 * period_s
    (*_, last) = BatchSmoother().smooth(first)["ff1"]
    assert float(np.hypot(last.position_m[0] - period_s, last.position_m[1])) < 0.1 * period_s


def test_it_makes_no_difference_in_which_order_the_first_reports_come() -> None:
    readings = walk(5)
    early = [r for r in readings if r.t != 5.0 or not isinstance(r, Displacement)]
    late = [r for r in readings if r not in early]
    assert shown(tracked([*early, *late])) == shown(tracked(readings))


def test_a_tracker_that_is_restored_awaits_a_first_report_as_well() -> None:
    readings = walk(8)
    for stopped in (6, 11, 14):
        tracker = KirchhoffTracker.restore(tracked(readings[:stopped]).snapshot())
        for reading in readings[stopped:]:
            tracker.fold([reading])
        assert shown(tracker) == shown(tracked(readings))


def test_only_the_first_report_of_a_unit_is_awaited_and_none_that_is_short_or_sums_up_a_silence() -> None:
    first = FirstReports()
    assert first.awaited([report(0.0, 5.0), report(5.0, 10.0)]) == [Awaited(t=0.0, node="ff1", told_t=5.0)]
    assert first.awaited([report(10.0, 18.0)]) == []
    assert FirstReports().awaited([report(4.0, 5.0), report(5.0, 15.0)]) == []
    assert FirstReports().awaited([report(0.0, 60.0)]) == []
    assert FirstReports().awaited([Displacement(t=9.0, node="ff1", delta_m=(9.0, 0.0, 0.0))]) == []
