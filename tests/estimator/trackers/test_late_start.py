"""A log that begins only when people are inside: nobody said where they entered, and radios tell."""

import math
from collections.abc import Iterable, Sequence

import pytest
from msgspec.structs import replace

from estimator.estimate import NodeEstimate
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE, outside
from tests.estimator.trackers.entry import BASE, EAST, Place, followed, off_m, step, surely_elsewhere

BEGINS, SOON_S = 100, 4
"""When the log begins (s); by then it is to be clear that nobody was at the base (s)."""
ANCHORS = {"a1": (30.0, 20.0), "a2": (60.0, -5.0), "a3": (20.0, -15.0)}
CRUMBS = {"b1": (30.0, 0.0), "b2": (50.0, 3.0), "b3": (45.0, 15.0)}
PLACES = {"base": (0.0, 0.0), **ANCHORS, **CRUMBS}


def way(start: Place, second: int) -> Place:
    return start[0] + EAST[0] * (second - BEGINS), start[1]


def walked(start: Place, seconds: int, radios: Iterable[str]) -> list[AnyReading]:
    """He walks east from where he is when the log begins, and ranges some radios."""
    found: list[AnyReading] = [base_there()]
    found += [
        Node(t=float(BEGINS), node=name, role="anchor", position_m=(*at, 0.0))
        for name, at in ANCHORS.items()
        if name in radios
    ]
    for second in range(BEGINS, BEGINS + seconds):
        found.append(step(float(second), EAST))
        for name in radios:
            metres = math.dist(way(start, second), PLACES[name])
            found.append(
                Range(t=float(second), a="ff1", b=name, range_m=metres, sigma_m=0.1, technology="uwb")
            )
    return found


def base_there() -> Node:
    return Node(t=float(BEGINS), node="base", role="base", position_m=BASE.position_m)


def wrong(found: Sequence[tuple[int, NodeEstimate]], start: Place) -> list[int]:
    """The seconds in which he is shown elsewhere, sure of it, but for the first ones."""
    return surely_elsewhere(found, lambda second: way(start, second), BEGINS + SOON_S)


@pytest.mark.parametrize("start", [(40.0, 4.0), (25.0, 12.0)])
@pytest.mark.parametrize("introduced", [False, True])
def test_who_is_ranged_by_anchors_is_where_they_say_and_not_at_the_base(
    start: Place, introduced: bool
) -> None:
    told = [Node(t=float(BEGINS), node="ff1", role="responder")] if introduced else []
    readings = [*told, *walked(start, 40, ("base", *ANCHORS))]
    found = followed(readings, BEGINS)
    assert wrong(found, start) == []
    assert off_m(found[-1][1], way(start, BEGINS + 39)) < 0.5
    track = BatchSmoother().smooth(readings)["ff1"]
    assert math.dist(track[-1].position_m[:2], way(start, BEGINS + 39)) < 0.5


@pytest.mark.parametrize("radios", [["base"], list(CRUMBS), ["base", *CRUMBS]])
def test_as_long_as_nothing_tells_where_he_is_he_is_shown_and_nobody_is_sure(radios: Sequence[str]) -> None:
    """On a ring about the base, or beside breadcrumbs that nobody has dropped."""
    start = (40.0, 4.0)
    readings = walked(start, 30, radios)
    found = followed(readings, BEGINS)
    assert wrong(found, start) == []
    assert all(one.position_m is not None for _, one in found)
    for point in BatchSmoother().smooth(readings)["ff1"]:
        assert outside(point.position_m, point.covariance_m2, way(start, int(point.t))) < SURE


@pytest.mark.parametrize(("start", "radios", "said"), [((40.0, 4.0), CRUMBS, 1), ((1.0, 0.5), ["base"], 0)])
def test_of_whom_that_is_doubted_it_is_said_once_and_what_would_tell(
    start: Place, radios: Iterable[str], said: int
) -> None:
    tracker = KirchhoffTracker()
    tracker.fold(walked(start, 30, radios))
    found = [notice for notice in tracker.take_notices() if "inside already" in notice.text]
    assert [notice.node for notice in found] == ["ff1"] * said
    assert all("A fix (`position`)" in notice.text for notice in found)


def test_who_is_doubted_is_where_a_fix_says_and_no_longer_doubted() -> None:
    start, seconds = (40.0, 4.0), 30
    here = way(start, BEGINS + 20)
    told = Position(t=BEGINS + 20.2, node="ff1", position_m=(*here, 0.0), sigma_m=(1.0, 1.0, 2.0))
    (_, one) = followed([*walked(start, seconds, CRUMBS), told], BEGINS)[-1]
    assert off_m(one, way(start, BEGINS + seconds - 1)) < 2.0
    assert one.covariance_m2 is not None
    assert math.sqrt(one.covariance_m2[0]) < 3.0


def test_whose_own_readings_say_that_he_enters_is_believed_beside_breadcrumbs_of_before() -> None:
    """Radios that were there before the fire are no reason to doubt who is ranged at the door."""
    start = (1.0, 0.5)
    found = followed(walked(start, 30, ["base", *CRUMBS]), BEGINS)
    assert wrong(found, start) == []
    covariance = found[-1][1].covariance_m2
    assert covariance is not None
    assert math.sqrt(covariance[0]) < 5.0


@pytest.mark.parametrize("wild_s", [1, 2])
def test_a_wild_range_or_two_let_nobody_begin_elsewhere(wild_s: int) -> None:
    start = (1.0, 0.5)
    readings = [
        replace(reading, range_m=reading.range_m + 60.0)
        if isinstance(reading, Range) and reading.t < BEGINS + wild_s
        else reading
        for reading in walked(start, 30, ["base"])
    ]
    found = followed(readings, BEGINS)
    assert wrong(found, start) == []
    assert all(one.position_m is not None for _, one in found)
    assert off_m(found[-1][1], way(start, BEGINS + 29)) < 5.0


def test_he_is_found_once_he_comes_by_the_base() -> None:
    seconds, start = 120, (-50.0, 0.5)
    readings = [
        reading
        for reading in walked(start, seconds, ["base", *CRUMBS])
        if not isinstance(reading, Range) or reading.range_m < 50.0 or reading.b != "base"
    ]
    found = followed(readings, BEGINS)
    assert wrong(found, start) == []


@pytest.mark.parametrize("radios", [[], ["base"], ["base", "b1", "b2"], ["base", *ANCHORS]])
def test_who_starts_at_the_door_is_shown_there_at_once_and_stays(radios: Sequence[str]) -> None:
    start = (1.0, 0.5)
    found = followed(walked(start, 20, radios), BEGINS)
    assert all(one.position_m is not None for _, one in found)
    assert max(off_m(one, way(start, second)) for second, one in found) < 5.0


def test_who_is_told_to_be_at_the_base_is_at_the_base() -> None:
    """A gateway has said so: radios do not undo it as they undo what was only assumed."""
    told = Node(t=float(BEGINS), node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.5)
    found = followed([told, *walked((0.0, 0.0), 20, CRUMBS)], BEGINS)
    assert all(one.position_m is not None for _, one in found)
    assert off_m(found[-1][1], way((0.0, 0.0), BEGINS + 19)) < 1.0


def test_a_tracker_that_is_restored_afterwards_goes_on_alike() -> None:
    readings = walked((40.0, 4.0), 40, ("base", *ANCHORS))
    tracker = KirchhoffTracker()
    tracker.fold([reading for reading in readings if reading.t < BEGINS + 6])
    restored = KirchhoffTracker.restore(tracker.snapshot())
    for one in (tracker, restored):
        one.fold([reading for reading in readings if reading.t >= BEGINS + 6])
    assert tracker.estimates() == restored.estimates()
