"""Whose clock is behind is told, with the gateway and by how much; what was only held back is not."""

import json
from collections.abc import Iterable

from backend.live.record import RecordClock
from backend.log.base import LoggedBatch
from backend.log.batch import accepted_readings
from backend.tracking.fold import IncidentFold
from backend.tracking.gateway_clocks import BEHIND_S, KEPT, SPAN_S
from estimator.trackers.base import TrackerSettings

T0 = 1_763_712_345.0
HOUR_S = 3600.0
TOLD_AFTER_S = 2 * SPAN_S + 1


def came(received: float, t: float, gateway: str = "engine-7", sent: float | None = None) -> LoggedBatch:
    step = {"kind": "displacement", "t": t, "node": f"ff-{gateway}", "delta_m": [0.1, 0.0, 0.0]}
    body = json.dumps({"gateway": gateway, "batch": "b", "readings": [step]})
    return LoggedBatch(
        seq=round((received - T0) * 100) + 1,
        gateway=gateway,
        batch=f"{gateway} {received}",
        received=received,
        sent=sent,
        body=body.encode(),
        rejected=(),
    )


def told(
    *batches: LoggedBatch, live: bool = True, fold: IncidentFold | None = None
) -> dict[str, RecordClock]:
    fold = fold or IncidentFold("kirchhoff", TrackerSettings(), live)
    for batch in batches:
        for _ in fold.fold(batch, accepted_readings(batch)):
            pass
    return {clock.gateway: clock for clock in fold.picture().clocks}


def each_second(seconds: float, behind_s: float, since: float = 0.0) -> list[LoggedBatch]:
    """Batches of a gateway whose clock is behind; each comes 0.3 to 0.9 s after its newest reading."""
    times = (since + at for at in range(int(seconds) + 1))
    return [came(T0 + s, T0 + s - behind_s - 0.3 * (1 + s % 3)) for s in times]


def test_a_clock_an_hour_behind_is_told_with_the_gateway_and_by_how_much() -> None:
    [clock] = told(*each_second(TOLD_AFTER_S, HOUR_S)).values()
    assert (clock.gateway, clock.behind_s, clock.clock_of) == ("engine-7", HOUR_S, "gateway")
    assert clock.t == T0 + int(TOLD_AFTER_S)
    assert told(*each_second(TOLD_AFTER_S, BEHIND_S - 1)) == {}


def test_beside_a_gateway_whose_clock_is_right_only_the_one_that_is_behind_is_told() -> None:
    right = [came(T0 + s, T0 + s - 0.5, "ladder-3") for s in range(30)]
    wrong = each_second(29, HOUR_S)
    both = [batch for pair in zip(right, wrong, strict=True) for batch in pair]
    assert set(told(*both)) == {"engine-7"}


def test_where_the_gateway_says_rightly_when_it_sent_the_clocks_are_its_units() -> None:
    def sent_late_by(late_s: float) -> Iterable[LoggedBatch]:
        for s in range(30):
            yield came(T0 + s, T0 + s - HOUR_S, sent=T0 + s - late_s)

    assert told(*sent_late_by(0.2))["engine-7"].clock_of == "units"
    assert told(*sent_late_by(HOUR_S))["engine-7"].clock_of == "gateway"


def test_what_was_held_back_for_an_hour_and_comes_at_last_tells_nothing_of_a_clock() -> None:
    # 720 s of readings a minute of reception, as a gateway sends that was out of reach.
    held_back = [came(T0 + s, T0 - HOUR_S + 12 * s) for s in range(300)]
    fold = IncidentFold("kirchhoff", TrackerSettings(), live=True)
    assert [told(batch, fold=fold) for batch in held_back] == [{}] * 300


def test_a_batch_that_was_sent_again_after_seconds_changes_nothing() -> None:
    batches = each_second(40, HOUR_S)
    batches[15] = came(batches[15].received, batches[15].received - HOUR_S - 8)
    assert told(*batches)["engine-7"].behind_s == HOUR_S


def test_once_the_clock_is_set_it_is_told_no_more() -> None:
    fold = IncidentFold("kirchhoff", TrackerSettings(), live=True)
    assert told(*each_second(30, HOUR_S), fold=fold)
    assert told(*each_second(0, 0.0, since=31), fold=fold) == {}


def test_who_only_exercises_or_replays_has_no_clock_that_is_wrong() -> None:
    assert told(*each_second(30, HOUR_S), live=False) == {}


def test_what_is_known_of_clocks_outlives_the_worker() -> None:
    fold = IncidentFold("kirchhoff", TrackerSettings(), live=True)
    told(*each_second(12, HOUR_S), fold=fold)
    after = IncidentFold.restore(fold.state(), "kirchhoff", TrackerSettings(), live=True)
    assert told(*each_second(10, HOUR_S, since=13), fold=after)


def test_a_gateway_that_makes_up_names_fills_no_more_than_there_is_room_for() -> None:
    many = [came(T0 + s + n / 1000, T0 + s - HOUR_S, f"g{n}") for s in (0, 11, 22) for n in range(KEPT + 20)]
    assert len(told(*many)) <= KEPT
