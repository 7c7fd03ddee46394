"""Folding is a function of the log: nothing of when, how often or by whom it is done is in the rows."""

import random

import pytest
from msgspec.structs import replace

from backend.live import record
from backend.log.base import RecordedFrame
from backend.tracking.fold import IncidentFold, OtherState
from estimator.measurements import Alarm, AnyReading, Displacement, Node, Status
from estimator.measurements.status import AlarmState
from estimator.trackers import kirchhoff
from estimator.trackers.base import TrackerSettings
from tests.backend.tracking.conftest import entry, fold_all, walk

SETTINGS = TrackerSettings()


def test_a_fold_that_is_restored_anywhere_makes_the_same_rows() -> None:
    batches = walk(30)
    whole = IncidentFold("kirchhoff", SETTINGS)
    rows = fold_all(whole, batches)
    assert [row.second for row in rows] == list(range(1000, 1031))
    for cut in random.Random(5).sample(range(1, len(batches)), 6):
        first = IncidentFold("kirchhoff", SETTINGS)
        before = fold_all(first, batches[:cut])
        second = IncidentFold.restore(first.state(), "kirchhoff", SETTINGS)
        after = fold_all(second, batches[cut:], first=cut + 1)
        assert before + after == rows, f"cut after entry {cut}"
        assert second.last_row() == whole.last_row()


def test_a_call_that_nobody_has_acknowledged_outlives_the_worker() -> None:
    def said(t: float, state: AlarmState, text: str | None = None) -> list[AnyReading]:
        return [Alarm(t=t, node="ff1", alarm="mayday", state=state, text=text)]

    batches: list[list[AnyReading]] = [
        said(10.0, "raised", "second floor"),
        said(11.0, "cleared", "switched off"),
        said(13.0, "raised", "leg broken"),
        said(14.0, "acknowledged", "RIT: E7"),
        said(16.0, "raised", "still here"),
        said(17.0, "cleared"),
        said(19.0, "acknowledged"),
        [Status(t=21.0, node="ff1", battery=0.5)],
    ]
    rows = fold_all(IncidentFold("kirchhoff", SETTINGS), batches)
    states = [[alarm.state for alarm in record.decode(row.record).alarms] for row in rows]
    assert states == [["raised"], ["cleared"], ["raised"], ["acknowledged"], ["raised"], ["cleared"], []]
    for cut in range(1, len(batches)):
        first = IncidentFold("kirchhoff", SETTINGS)
        before = fold_all(first, batches[:cut])
        second = IncidentFold.restore(first.state(), "kirchhoff", SETTINGS)
        assert before + fold_all(second, batches[cut:], first=cut + 1) == rows, f"cut after entry {cut}"


def test_a_call_from_a_clock_that_is_ahead_is_of_when_it_came_and_carries_no_time_away() -> None:
    ahead = Alarm(t=90_000.0, node="ahead", alarm="mayday", state="raised")
    for live, moment in ((True, {"received": 1010.0}), (False, {"received": 5e6, "sent": 1010.0})):
        fold = IncidentFold("kirchhoff", SETTINGS, live=live)
        fold_all(fold, walk(5))
        list(fold.fold(replace(entry(100), **moment), [ahead]))
        call = next(alarm for alarm in fold.picture().alarms if alarm.node == "ahead")
        assert (call.state, call.t) == ("raised", 1010.0)
        assert fold.newest_t == 1010.0


def test_looking_at_the_picture_changes_nothing() -> None:
    batches = walk(20)
    quiet = fold_all(IncidentFold("kirchhoff", SETTINGS), batches)
    watched = IncidentFold("kirchhoff", SETTINGS)
    rows = []
    for seq, readings in enumerate(batches, start=1):
        for row in watched.fold(entry(seq), readings):
            watched.picture()
            if row is not None:
                rows.append(row)
        watched.last_row()
        watched.state()
    assert rows == quiet


def test_a_row_names_the_newest_entry_in_it() -> None:
    fold = IncidentFold("kirchhoff", SETTINGS)
    batches = walk(3)
    rows = fold_all(fold, batches)
    assert [(row.second, row.seq, row.received) for row in rows] == [
        (1000, 1, 1001.0),
        (1001, 2, 1002.0),
        (1002, 4, 1004.0),
        (1003, 5, 1005.0),  # the entry after it jumps ahead, the one that belonged here comes late
    ]


def test_the_row_of_the_current_second_is_replaced_by_the_one_that_is_final() -> None:
    batches = walk(10)
    fold = IncidentFold("kirchhoff", SETTINGS)
    seconds = set()
    for seq, readings in enumerate(batches, start=1):
        seconds |= {row.second for row in fold.fold(entry(seq), readings) if row is not None}
        current = fold.last_row()
        assert current is not None
        assert current.second not in seconds


def test_an_entry_without_readings_counts() -> None:
    fold = IncidentFold("kirchhoff", SETTINGS)
    assert fold_all(fold, [[], []]) == []
    assert (fold.seq, fold.newest_t, fold.last_row()) == (2, None, None)
    restored = IncidentFold.restore(fold.state(), "kirchhoff", SETTINGS)
    assert (restored.seq, restored.picture().nodes) == (2, ())


def test_a_state_for_other_settings_or_of_another_version_is_refused() -> None:
    fold = IncidentFold("kirchhoff", SETTINGS)
    fold_all(fold, walk(2))
    state = fold.state()
    with pytest.raises(OtherState, match="settings"):
        IncidentFold.restore(state, "kirchhoff", TrackerSettings(lag_s=5.0))
    with pytest.raises(OtherState, match="version"):
        IncidentFold.restore(state[:1] + b"\x63" + state[2:], "kirchhoff", SETTINGS)
    with pytest.raises(OtherState):
        IncidentFold.restore(b"nonsense", "kirchhoff", SETTINGS)
    with pytest.raises(OtherState):
        IncidentFold.restore(state[:-20], "kirchhoff", SETTINGS)


def test_a_state_whose_tracker_is_of_another_version_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    fold = IncidentFold("kirchhoff", SETTINGS)
    fold_all(fold, walk(2))
    state = fold.state()
    monkeypatch.setattr(kirchhoff, "VERSION", kirchhoff.VERSION + 1)
    with pytest.raises(OtherState, match="fold the log anew"):
        IncidentFold.restore(state, "kirchhoff", SETTINGS)


def test_two_responders_relative_position_is_told() -> None:
    fold = IncidentFold("kirchhoff", SETTINGS)
    fold_all(fold, walk(5))
    relative = fold.relative("ff1", "ff2")
    assert relative is not None
    assert relative.delta_m[0] == pytest.approx(-1.0, abs=1.0)
    with pytest.raises(KeyError):
        fold.relative("ff1", "nobody")


AHEAD_S = 59.0


def by_two_gateways(seconds: int) -> list[list[AnyReading]]:
    """Entry `n` comes at 1000 + n: one gateway's clock is right, the other's is nearly a minute fast."""
    entered: list[AnyReading] = [
        Node(t=1000.0, node="base", role="base"),
        *(Node(t=1000.0, node=name, role="responder", position_m=(0.0, 0.0, 0.0)) for name in ("ff1", "ff2")),
    ]
    batches = [entered]
    for second in range(1, seconds + 1):
        t, step = 1000.0 + second, (1.0, 0.0, 0.0)
        batches.append([Displacement(t=t + AHEAD_S, from_t=t + AHEAD_S - 1.0, node="ff2", delta_m=step)])
        batches.append([Displacement(t=t - 1.5, from_t=t - 2.5, node="ff1", delta_m=step)])
    return batches


def fold_live(seconds: int) -> IncidentFold:
    fold = IncidentFold("kirchhoff", TrackerSettings(lag_s=30.0), live=True)
    for seq, readings in enumerate(by_two_gateways(seconds)):
        batch = replace(entry(seq + 1), received=1000.0 + (seq + 1) // 2)
        assert list(fold.fold(batch, readings))
    return fold


def fold_as_received(
    batches: list[tuple[float, list[AnyReading]]], fold: IncidentFold
) -> list[RecordedFrame]:
    """The rows of a live incident, from batches with the times at which they came."""
    return [
        row
        for seq, (received, readings) in enumerate(batches, start=fold.seq + 1)
        for row in fold.fold(replace(entry(seq), received=received), readings)
        if row is not None
    ]


def mayday_before_a_gap() -> list[tuple[float, list[AnyReading]]]:
    """Somebody calls, and the gateway's link is lost for ten seconds, whose readings come all at once."""
    entered = Node(t=1000.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0))
    called = Alarm(t=1000.3, node="ff1", alarm="mayday", state="raised")
    steps: list[AnyReading] = [
        Displacement(t=1000.5 + k, from_t=999.5 + k, node="ff1", delta_m=(1.0, 0.0, 0.0)) for k in range(10)
    ]
    return [(1000.1, [entered]), (1000.4, [called]), (1005.0, []), (1010.5, steps)]


def test_what_stood_on_the_screens_while_a_link_was_lost_is_recorded_as_it_was() -> None:
    fold = IncidentFold("kirchhoff", SETTINGS, live=True)
    rows = fold_as_received(mayday_before_a_gap(), fold)
    stood = next(row for row in rows if row.second == 1001)
    assert stood.received == 1000.4
    assert [alarm.node for alarm in record.decode(stood.record).alarms] == ["ff1"]
    assert [row.second for row in rows] == [1000, *range(1001, 1010)]
    assert all(row.received == 1010.5 for row in rows if row.second > 1001)


def test_what_comes_late_for_a_second_that_stood_is_in_the_next_row() -> None:
    fold = IncidentFold("kirchhoff", SETTINGS, live=True)
    rows = fold_as_received(
        [*mayday_before_a_gap()[:3], (1010.5, [Status(t=1000.6, node="ff1", battery=0.5)])], fold
    )
    last = fold.last_row()
    assert last is not None
    assert [row.second for row in [*rows, last]] == [1000, 1001, 1002]
    assert [n.battery for row in [*rows[1:], last] for n in record.decode(row.record).nodes] == [None, 0.5]


def test_what_came_late_for_a_second_that_stood_is_recorded_though_time_leaps_past_its_row() -> None:
    entered = Node(t=1000.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0))
    fold = IncidentFold("kirchhoff", SETTINGS, live=True)
    rows = fold_as_received(
        [
            (1000.1, [entered]),
            (1000.7, [Status(t=1000.6, node="ff1", air_bar=200.0)]),
            (1004.0, [Status(t=1000.2, node="ff1", battery=0.5)]),
        ],
        fold,
    )
    standing = fold.last_row()
    rows += fold_as_received([(1005.0, [Status(t=1004.9, node="ff1", air_bar=190.0)])], fold)
    assert [(row.second, row.seq) for row in rows] == [(1000, 1), (1001, 2), (1002, 3)]
    assert rows[-1] == standing


def test_screens_that_only_a_gateway_far_behind_feeds_are_recorded_while_they_are_shown() -> None:
    entered = Node(t=1000.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0))
    behind: list[tuple[float, list[AnyReading]]] = [
        (1000.2 + k / 2, [Status(t=980.2 + k / 2, node="ff1", air_bar=float(k))]) for k in range(40)
    ]
    rows = fold_as_received([(1000.1, [entered]), *behind], IncidentFold("kirchhoff", SETTINGS, live=True))
    for wall_t in range(1004, 1019):
        shown = max(row.received for row in rows if row.second <= wall_t and row.received <= wall_t)
        assert wall_t - shown <= 3.0


def test_gateways_that_are_all_behind_by_the_same_have_their_seconds_recorded_whole() -> None:
    def rows_of(behind_s: float) -> list[tuple[int, int]]:
        fold = IncidentFold("kirchhoff", SETTINGS, live=True)
        batches: list[tuple[float, list[AnyReading]]] = [
            (1000.0 + k + behind_s, [Status(t=1000.0 + k - 0.2, node="ff1", air_bar=float(k))])
            for k in range(20)
        ]
        return [(row.second, row.seq) for row in fold_as_received(batches, fold)]

    assert rows_of(50.0) == rows_of(0.0)


def test_a_fold_that_is_restored_knows_what_stood() -> None:
    batches = mayday_before_a_gap()
    rows = fold_as_received(batches, IncidentFold("kirchhoff", SETTINGS, live=True))
    for cut in range(1, len(batches)):
        first = IncidentFold("kirchhoff", SETTINGS, live=True)
        before = fold_as_received(batches[:cut], first)
        second = IncidentFold.restore(first.state(), "kirchhoff", SETTINGS, live=True)
        assert before + fold_as_received(batches[cut:], second) == rows


def test_a_fast_clock_makes_nobody_elses_readings_late() -> None:
    by_name = {node.node: node for node in fold_live(20).picture().nodes}
    assert by_name["ff1"].t == 1018.5
    assert by_name["ff1"].position_m == pytest.approx((19.0, 0.0, 0.0), abs=1.0)


def test_nobody_is_newer_than_when_he_was_heard_of() -> None:
    fold = fold_live(20)
    by_name = {node.node: node for node in fold.picture().nodes}
    assert by_name["ff2"].t == 1020.0
    assert fold.newest_t == 1020.0
    list(fold.fold(replace(entry(100), received=1050.0), [Status(t=1049.0, node="ff1", battery=0.5)]))
    assert {node.node: node.t for node in fold.picture().nodes}["ff2"] == 1020.0


def test_a_fold_that_is_restored_knows_when_a_fast_clocks_bearer_was_heard_of() -> None:
    fold = fold_live(20)
    again = IncidentFold.restore(fold.state(), "kirchhoff", TrackerSettings(lag_s=30.0), live=True)
    assert again.picture() == fold.picture()


def test_where_readings_are_the_clock_their_epochs_stand() -> None:
    fold = IncidentFold("kirchhoff", TrackerSettings(lag_s=90.0))
    fold_all(fold, by_two_gateways(20))
    assert {node.node: node.t for node in fold.picture().nodes}["ff2"] == 1020.0 + AHEAD_S
    assert fold.newest_t == 1020.0 + AHEAD_S
