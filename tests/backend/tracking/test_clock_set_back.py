"""A server's clock that was ahead and is put right: who is reported goes on moving."""

from collections.abc import Iterator

import pytest
from msgspec.structs import replace

from backend.live import record
from backend.live.record import RecordNode
from backend.log.base import LoggedBatch, RecordedFrame
from backend.tracking.clock_set_back import MonotonicClock, OneClock
from backend.tracking.fold import IncidentFold
from estimator.measurements import Alarm, AnyReading, Displacement, Node, Status
from estimator.trackers.base import TrackerSettings
from tests.backend.tracking.conftest import entry

SETTINGS = TrackerSettings()
START_T = 1_000_000.0
HOUR_S = 3600.0

Entry = tuple[LoggedBatch, list[AnyReading]]


def walked(seconds: int, server_ahead: dict[int, float], gateway_ahead: dict[int, float]) -> Iterator[Entry]:
    """A metre east each second; both clocks are ahead (s) from the seconds on that are told."""
    server_s = gateway_s = 0.0
    for second in range(seconds):
        server_s, gateway_s = server_ahead.get(second, server_s), gateway_ahead.get(second, gateway_s)
        t = START_T + second + gateway_s
        step = Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(1.0, 0.0, 0.0))
        readings: list[AnyReading] = [step]
        if second == 0:
            readings.insert(0, Node(t=t - 1.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0)))
        received = START_T + second + 0.2 + server_s
        if t > received + 60.0:
            readings = []  # set aside as it comes in
        yield replace(entry(second + 1), received=received), readings


def folded(
    entries: Iterator[tuple[LoggedBatch, list[AnyReading]]],
) -> tuple[IncidentFold, list[RecordedFrame]]:
    fold = IncidentFold("kirchhoff", SETTINGS, live=True)
    return fold, [row for one in entries for row in fold.fold(*one) if row is not None]


def ff1(fold: IncidentFold) -> RecordNode:
    return next(node for node in fold.picture().nodes if node.node == "ff1")


def east_m(fold: IncidentFold) -> float:
    position_m = ff1(fold).position_m
    assert position_m is not None
    return position_m[0]


def test_who_is_reported_by_a_clock_that_was_put_right_goes_on_from_where_he_was() -> None:
    ahead = {0: HOUR_S, 20: 0.0}
    fold, rows = folded(walked(40, ahead, ahead))
    assert east_m(fold) == pytest.approx(40.0, abs=1.0)
    assert ff1(fold).t == pytest.approx(START_T + 39.0, abs=1.0)
    seconds = [row.second for row in rows]
    assert seconds[-1] == START_T + 38
    assert [s for s in seconds if s > START_T + 1000] == [START_T + HOUR_S + s for s in range(-1, 19)]
    (notice,) = fold.picture().notices
    assert notice.code == "clock_put_back"
    assert notice.t == pytest.approx(START_T + 20.2, abs=1.0)


def test_where_the_gateways_were_right_all_along_nothing_is_put_back() -> None:
    for server_ahead in ({0: HOUR_S, 20: 0.0}, {10: -HOUR_S, 20: 0.0}, {10: -40.0, 20: 0.0}):
        fold, _ = folded(walked(40, server_ahead, {}))
        assert fold.clock.ahead_s == 0, server_ahead
        assert ff1(fold).t == START_T + 39.0


def test_who_comes_late_by_much_puts_no_clock_back() -> None:
    entries = list(walked(40, {}, {}))
    late = Displacement(t=START_T - 5000.0, node="ff2", delta_m=(1.0, 0.0, 0.0))
    entries[30][1].insert(0, late)
    fold, _ = folded(iter(entries))
    assert fold.clock.ahead_s == 0


def test_a_clock_may_be_put_back_twice() -> None:
    ahead = {0: 2 * HOUR_S, 20: HOUR_S, 40: 0.0}
    fold, _ = folded(walked(60, ahead, ahead))
    assert east_m(fold) == pytest.approx(60.0, abs=1.0)
    assert ff1(fold).t == pytest.approx(START_T + 59.0, abs=2.0)


def test_a_fold_that_is_restored_anywhere_knows_of_the_clock() -> None:
    ahead = {0: HOUR_S, 20: 0.0}
    entries = list(walked(40, ahead, ahead))
    whole, rows = folded(iter(entries))
    for cut in (5, 19, 20, 21, 35):
        first, before = folded(iter(entries[:cut]))
        second = IncidentFold.restore(first.state(), "kirchhoff", SETTINGS, live=True)
        after = [row for one in entries[cut:] for row in second.fold(*one) if row is not None]
        assert before + after == rows
        assert second.last_row() == whole.last_row()


def test_alarms_vitals_and_who_is_set_aside_are_told_by_the_clock_that_is_right_now() -> None:
    fold, _ = folded(walked(20, {0: HOUR_S}, {0: HOUR_S}))
    t = START_T + 20.0
    said: list[AnyReading] = [
        Status(t=t, node="ff1", battery=0.5, air_bar=200.0),
        Alarm(t=t, node="ff1", alarm="mayday", state="raised"),
    ]
    list(fold.fold(replace(entry(21), received=t + 0.2), said))
    picture = fold.picture()
    assert picture.alarms[0].t == pytest.approx(t, abs=1.0)
    assert ff1(fold).air_t == pytest.approx(t, abs=1.0)
    assert picture.t == pytest.approx(t, abs=1.0)
    row = fold.last_row()
    assert row is not None
    assert row.second == pytest.approx(t, abs=1.0)
    assert row.received == t + 0.2
    assert record.decode(row.record) == picture


def test_a_call_for_help_alone_puts_no_clock_back_and_is_heard() -> None:
    fold, _ = folded(walked(20, {0: HOUR_S}, {0: HOUR_S}))
    call = Alarm(t=START_T + 20.0, node="ff1", alarm="mayday", state="raised")
    list(fold.fold(replace(entry(21), received=START_T + 20.2), [call]))
    assert fold.clock.ahead_s == 0
    assert [alarm.alarm for alarm in fold.picture().alarms] == ["mayday"]


def test_a_whole_log_is_read_on_one_clock() -> None:
    ahead = {0: HOUR_S, 20: 0.0}
    clock = OneClock(live=True)
    readings = [reading for entry in walked(40, ahead, ahead) for reading in clock.take(*entry)]
    times = [reading.until_t - clock.ahead_s for reading in readings]
    assert times == sorted(times)
    assert times[-1] == START_T + 39.0
    assert times[0] == pytest.approx(START_T - 1.0, abs=2.0)
    assert clock.newest_t == START_T + 39.0 + clock.ahead_s


def test_a_recorded_log_goes_by_its_readings_whatever_the_clock_does() -> None:
    ahead = {0: HOUR_S, 20: 0.0}
    clock = OneClock(live=False)
    for batch, readings in walked(40, ahead, ahead):
        assert clock.take(batch, readings) == readings
    assert clock.ahead_s == 0
    assert clock.newest_t == START_T + 19.0 + HOUR_S


def test_no_epoch_of_a_live_incident_is_newer_than_it_came() -> None:
    clock = OneClock(live=True)
    assert clock.newest_t is None
    tomorrow = Displacement(t=START_T + 24.0 * HOUR_S, node="ff1", delta_m=(1.0, 0.0, 0.0))
    clock.take(replace(entry(1), received=START_T), [tomorrow])
    assert clock.newest_t == START_T


def test_a_clock_that_goes_on_is_never_put_back_by_less_than_clocks_may_be_wrong() -> None:
    clock = MonotonicClock()
    step = [Displacement(t=1000.0, node="ff1", delta_m=(1.0, 0.0, 0.0))]
    clock.hear(1059.0, step, None)
    assert clock.hear(1000.0, step, 1059.0) == 0
    assert clock.hear(990.0, step, 1059.0) == 0  # its epoch did not go back as well
