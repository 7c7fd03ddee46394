"""Of whom nobody said where he entered, and whose unit reports when others have been inside for long."""

import math
from collections.abc import Iterable, Sequence

import numpy as np
import pytest

from estimator.estimate import NodeEstimate
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.trackers.entry import (
    BASE,
    EAST,
    Place,
    followed,
    off_m,
    shown,
    squared_error,
    step,
    surely_elsewhere,
)

LATE = 200
ANCHORS = {"a1": (30.0, 20.0), "a2": (60.0, -5.0), "a3": (20.0, -15.0)}
PLACED = [Node(t=0.0, node=name, role="anchor", position_m=(*at, 0.0)) for name, at in ANCHORS.items()]


def others_inside(until: int) -> list[AnyReading]:
    """The base and a first crew, which has been inside since the beginning."""
    crew = [
        Displacement(t=float(second), node="first", delta_m=(0.0, 0.0, 0.0)) for second in range(1, until)
    ]
    return [BASE, *PLACED, *crew]


def ranged(t: float, at: Place, radios: Iterable[str] = ANCHORS, chance: float = 0.0) -> list[AnyReading]:
    places = {"base": (0.0, 0.0), **ANCHORS}
    return [
        Range(
            t=t, a="ff1", b=name, range_m=math.dist(at, places[name]) + chance, sigma_m=0.1, technology="uwb"
        )
        for name in radios
    ]


def way(start: Place, second: int) -> Place:
    return start[0] + EAST[0] * (second - LATE), start[1]


def walked(start: Place, seconds: int, radios: Sequence[str]) -> list[AnyReading]:
    """He walks east from a place at which his unit reports first, and is ranged by some radios."""
    found: list[AnyReading] = []
    for second in range(LATE, LATE + seconds):
        found += [step(float(second), EAST), *ranged(float(second), way(start, second), radios)]
    return found


def wrong(found: Sequence[tuple[int, NodeEstimate]], start: Place) -> list[int]:
    return surely_elsewhere(found, lambda second: way(start, second))


@pytest.mark.parametrize("start", [(40.0, 4.0), (25.0, 12.0), (0.0, 0.0), (-2.0, 1.0)])
def test_who_is_heard_late_is_where_his_ranges_say(start: Place) -> None:
    found = followed([*others_inside(LATE), *walked(start, 40, ("base", "a1", "a2", "a3"))], LATE)
    assert wrong(found, start) == []
    first = next(second for second, one in found if one.position_m is not None)
    assert first <= LATE + 5
    assert off_m(found[-1][1], way(start, LATE + 39)) < 0.5


def test_whom_the_base_alone_ranges_beside_itself_has_just_come_in() -> None:
    found = followed([*others_inside(LATE), *walked((1.0, 0.0), 30, ["base"])], LATE)
    assert wrong(found, (1.0, 0.0)) == []
    assert off_m(found[-1][1], way((1.0, 0.0), LATE + 29)) < 6.0


def test_whom_the_base_alone_ranges_from_afar_is_not_shown_at_the_base() -> None:
    found = followed([*others_inside(LATE), *walked((30.0, 30.0), 30, ["base"])], LATE)
    assert [second for second, one in found if one.position_m is not None] == []


def test_of_whom_nothing_is_heard_nobody_is_sure() -> None:
    found = followed([*others_inside(LATE), *walked((0.0, 0.0), 30, [])], LATE)
    last = found[-1][1]
    assert off_m(last, way((0.0, 0.0), LATE + 29)) < 5.0
    assert last.covariance_m2 is not None
    assert math.sqrt(last.covariance_m2[0]) > 20.0
    assert wrong(found, (40.0, 30.0)) == []


def test_who_was_unheard_is_found_by_ranges_and_not_on_a_side_by_chance() -> None:
    start = (40.0, 4.0)
    heard = [r for r in walked(start, 60, tuple(ANCHORS)) if isinstance(r, Displacement) or r.t > LATE + 30]
    readings = [*others_inside(LATE), *heard]
    found = followed(readings, LATE)
    assert wrong(found, start) == []
    assert off_m(found[-1][1], way(start, LATE + 59)) < 0.5
    track = BatchSmoother().smooth(readings)["ff1"]
    assert math.dist(track[-1].position_m[:2], way(start, LATE + 59)) < 0.5


def test_where_he_drops_something_of_whom_nothing_is_heard_nobody_knows() -> None:
    dropped = Drop(t=LATE + 10.0, node="b1", by="ff1")
    tracker = KirchhoffTracker()
    tracker.fold([*others_inside(LATE), *walked((0.0, 0.0), 20, []), dropped])
    assert all(estimate.node != "b1" or estimate.position_m is None for estimate in tracker.estimates())


def test_who_is_introduced_as_he_enters_is_at_the_base_however_late_that_is() -> None:
    told = Node(t=LATE - 2.0, node="ff1", role="responder")
    found = followed([*others_inside(LATE), told, *walked((0.0, 0.0), 20, [])], LATE)
    assert off_m(found[-1][1], way((0.0, 0.0), LATE + 19)) < 2.0
    covariance = found[-1][1].covariance_m2
    assert covariance is not None
    assert math.sqrt(covariance[0]) < 4.0


def test_who_has_been_on_the_roster_for_long_is_more_likely_to_enter_only_now_and_still_not_surely() -> None:
    """Most units are switched on at the door."""
    told = Node(t=1.0, node="ff1", role="responder")
    strangers, known = (
        followed([*others_inside(LATE), *some, *walked((0.0, 0.0), 20, [])], LATE)[-1][1]
        for some in ([], [told])
    )
    assert off_m(known, way((0.0, 0.0), LATE + 19)) < 2.0
    assert known.covariance_m2 is not None
    assert strangers.covariance_m2 is not None
    assert 5.0 < math.sqrt(known.covariance_m2[0]) < 0.5 * math.sqrt(strangers.covariance_m2[0])


def test_whom_ranges_have_named_first_walks_once_his_unit_reports() -> None:
    start, chance = (40.0, 4.0), np.random.default_rng(2)
    before = [
        r for s in range(LATE - 40, LATE) for r in ranged(float(s), start, chance=chance.normal(0.0, 0.1))
    ]
    readings = [*others_inside(LATE), *before, *walked(start, 40, tuple(ANCHORS))]
    found = followed(readings, LATE)
    assert {one.role for _, one in found} == {"responder"}
    assert wrong(found, start) == []
    assert off_m(found[-1][1], way(start, LATE + 39)) < 0.5


def test_who_comes_back_and_is_introduced_too_late_is_not_taken_to_enter_at_the_base() -> None:
    tracker = KirchhoffTracker()
    left: list[AnyReading] = [
        Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0)),
        step(1.0),
        Retire(t=20.0, node="ff1"),
    ]
    tracker.fold([*others_inside(LATE), *left])
    tracker.estimates()
    tracker.fold([Node(t=60.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0))])
    start = (40.0, 4.0)
    tracker.fold([step(float(second), EAST) for second in range(LATE, LATE + 10)])
    assert shown(tracker).position_m is None
    heard = [r for s in range(LATE + 10, LATE + 40) for r in ranged(float(s), way(start, s))]
    tracker.fold([*heard, *(step(float(second), EAST) for second in range(LATE + 10, LATE + 40))])
    assert off_m(shown(tracker), way(start, LATE + 39)) < 0.5
    assert squared_error(shown(tracker), way(start, LATE + 39)) < 9.0


def test_a_tracker_that_is_restored_while_somebody_is_unheard_goes_on_alike() -> None:
    readings = walked((40.0, 4.0), 60, tuple(ANCHORS))
    unheard = [r for r in readings if isinstance(r, Displacement) and r.t < LATE + 20]
    heard = [r for r in readings if r.t >= LATE + 20]
    tracker = KirchhoffTracker()
    tracker.fold([*others_inside(LATE), *unheard])
    restored = KirchhoffTracker.restore(tracker.snapshot())
    for one in (tracker, restored):
        one.fold(heard)
    assert tracker.estimates() == restored.estimates()
