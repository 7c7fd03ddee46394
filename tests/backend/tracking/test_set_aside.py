"""Who sends only readings that cannot be used is told, with the reason."""

import json
from typing import Any

import msgspec
from hypothesis import given
from hypothesis import strategies as st

from backend.live.record import RecordAside
from backend.log.base import LoggedBatch
from backend.log.batch import accepted_readings
from backend.log.decode import judge
from backend.tracking.fold import IncidentFold
from backend.tracking.set_aside import KEPT
from estimator.trackers.base import TrackerSettings

Reading = dict[str, Any]

T0 = 1000.0
SETTINGS = TrackerSettings()


def step(t: float, node: str, **other: object) -> Reading:
    return {"kind": "displacement", "t": t, "node": node, "delta_m": [1.0, 0.0, 0.0], **other}


def came(seq: int, received: float, *readings: Any) -> LoggedBatch:
    """A batch as the ingest logs it."""
    text = json.dumps({"gateway": "engine-7", "batch": f"b{seq}", "readings": readings})
    judged = judge(text.encode(), 10_000, received)
    return LoggedBatch(
        seq=seq,
        gateway="engine-7",
        batch=f"b{seq}",
        received=received,
        sent=None,
        body=text.encode(),
        rejected=judged.rejected,
    )


def folded(*batches: LoggedBatch, fold: IncidentFold | None = None) -> IncidentFold:
    fold = fold or IncidentFold("kirchhoff", SETTINGS, live=True)
    for batch in batches:
        for _ in fold.fold(batch, accepted_readings(batch)):
            pass
    return fold


def aside(*batches: LoggedBatch) -> dict[str, RecordAside]:
    return {known.name: known for known in folded(*batches).picture().set_aside}


def test_whose_clock_is_ahead_is_told_since_when_by_which_gateway_and_by_how_much() -> None:
    named = {"kind": "node", "node": "ff1", "role": "responder", "callsign": "E7-1", "crew": "E7"}
    first = came(1, T0, named | {"t": T0 + 600}, step(T0 + 601, "ff1"))
    assert aside(first, came(2, T0 + 5, step(T0 + 606, "ff1"))) == {
        "ff1": RecordAside(
            name="ff1",
            gateway="engine-7",
            since_t=T0,
            t=T0 + 5,
            code="time_in_future",
            text="clock 10 min ahead: set it",
            callsign="E7-1",
            crew="E7",
        )
    }


def test_whose_readings_are_not_understood_is_told_what_is_wrong_with_them() -> None:
    told = aside(came(1, T0, step(T0, "ff1", speed=2), {"kind": "rssi", "t": T0, "a": "ff2", "b": "b1"}))
    assert {name: known.code for name, known in told.items()} == {
        "ff1": "unknown_field",
        "ff2": "missing_field",
    }
    assert "not understood" in told["ff1"].text
    assert "speed" in told["ff1"].text


def test_who_does_not_say_who_he_is_is_known_by_the_gateway() -> None:
    told = aside(came(1, T0, 7, {"kind": "sonar", "t": T0}, step(T0, "\u0007")))
    assert [(known.name, known.gateway) for known in told.values()] == [("", "engine-7")]


def test_whose_reading_is_used_is_not_told_of_whether_it_came_after_or_with_the_other() -> None:
    ahead = step(T0 + 600, "ff1")
    assert aside(came(1, T0, ahead)).keys() == {"ff1"}
    assert aside(came(1, T0, ahead), came(2, T0 + 1, step(T0 + 1, "ff1"))) == {}
    assert aside(came(1, T0, ahead, step(T0, "ff1"))) == {}
    assert aside(came(1, T0, ahead), came(2, T0 + 1, {"kind": "retire", "t": T0, "node": "ff1"})) == {}


def test_a_gateway_that_makes_up_names_fills_no_more_than_there_is_room_for() -> None:
    batches = [came(1 + at, T0 + at, step(T0 + 9000, f"made-up-{at}")) for at in range(KEPT + 10)]
    assert list(aside(*batches)) == [f"made-up-{at}" for at in range(10, KEPT + 10)]


def test_who_is_set_aside_outlives_the_worker() -> None:
    first = folded(came(1, T0, step(T0 + 600, "ff1"), step(T0, "ff2")))
    second = IncidentFold.restore(first.state(), "kirchhoff", SETTINGS, live=True)
    assert second.picture() == first.picture()
    assert second.picture().set_aside


def test_a_row_that_was_damaged_stops_nobody() -> None:
    damaged = msgspec.structs.replace(came(1, T0, step(T0 + 600, "ff1")), body=b"{")
    fold = IncidentFold("kirchhoff", SETTINGS, live=True)
    assert list(fold.fold(damaged, [])) == []
    assert fold.picture().set_aside == ()


@given(
    st.dictionaries(
        st.sampled_from(["kind", "t", "node", "a", "callsign", "crew"]),
        st.none() | st.text() | st.integers() | st.floats() | st.lists(st.text(), max_size=2),
    )
)
def test_whatever_a_reading_says_what_is_told_of_it_can_be_shown(reading: Reading) -> None:
    batch = came(1, T0, msgspec.json.decode(msgspec.json.encode(reading)))
    assert batch.rejected
    for known in folded(batch).picture().set_aside:
        assert known.name.isprintable()
        assert len(known.name) <= 64
        assert known.text
