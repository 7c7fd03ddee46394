"""Who hears each other changes sides together; and a unit faces otherwise where its bearer came otherwise."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from msgspec.structs import replace

from estimator.estimate import NodeEstimate
from estimator.fusion.images import mirrored
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.smoothing.images.alternatives import Mode, alternatives_now
from estimator.smoothing.images.companions import companions_of, costed_images
from estimator.smoothing.images.flip_ambiguity import Flip, loose_steps
from estimator.smoothing.images.heading_images import faced, facing, turns_whole
from estimator.smoothing.images.image_estimates import apply_image
from estimator.smoothing.images.likeliest_image import likeliest_image
from estimator.smoothing.images.parts import Parts
from estimator.trackers.base import TrackerSettings
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.smoothing.images.test_flip_ambiguity import solved_of

Ways = dict[str, Array]
Radios = dict[str, tuple[float, float]]
ONE: Radios = {"base": (0.0, 0.0)}
TWO: Radios = {"a1": (0.0, 0.0), "a2": (20.0, 0.0)}
LINE = mirrored(np.zeros(2), 0.0)
HEARD_M = 15.0
SIDES = (1.0, -1.0)


def through(*corners_m: tuple[float, float], at_mps: float = 1.0) -> Array:
    """A way from corner to corner, second by second, k × 2 (m)."""
    way = [np.array(corners_m[0])]
    for corner in corners_m[1:]:
        off = np.array(corner) - way[-1]
        steps = max(round(float(np.hypot(*off)) / at_mps), 1)
        way += [way[-1] + off * (k + 1) / steps for k in range(steps)]
    return np.array(way)


def resting(at_m: Array | tuple[float, float], seconds: int) -> Array:
    """Somebody stands, k × 2 (m)."""
    return np.tile(np.array(at_m), (seconds, 1))


def readings_of(ways: Ways, radios: Radios, on_s: dict[str, int]) -> list[AnyReading]:
    """What they hear of the radios and of each other, and what units report that may face anything.

    Args:
        ways: where each of them is, second by second (m).
        radios: those that stand.
        on_s: when the unit is switched on of those who have one.
    """
    chance = np.random.default_rng(4)
    readings: list[AnyReading] = [
        Node(t=0.0, node=name, role="base" if name == "base" else "anchor", position_m=(*at, 0.0))
        for name, at in radios.items()
    ]
    for who, way in ways.items():
        east, north = way[0].tolist()
        sigma_rad = np.pi if who in on_s else None
        readings.append(
            Node(
                t=0.0,
                node=who,
                role="responder",
                position_m=(east, north, 0.0),
                sigma_m=0.2,
                heading_sigma_rad=sigma_rad,
            )
        )
    turned = np.array([[0.0, -1.0], [1.0, 0.0]])
    for second in range(1, min(len(way) for way in ways.values())):
        for who, way in ways.items():
            if second > on_s.get(who, 10_000):
                step = turned @ (way[second] - way[second - 1]) + chance.normal(0.0, 0.03, 2)
                e, n = step.tolist()
                readings.append(
                    Displacement(t=float(second), from_t=second - 1.0, node=who, delta_m=(e, n, 0.0))
                )
            others = {name: at[second] for name, at in ways.items() if name > who}
            for name, at in {**{n: np.array(p) for n, p in radios.items()}, **others}.items():
                off_m = float(np.hypot(*(way[second] - at)))
                if name in radios or off_m < HEARD_M:
                    range_m = abs(off_m + float(chance.normal(0.0, 0.1)))
                    readings.append(Range(t=float(second), a=who, b=name, range_m=range_m, technology="uwb"))
    return readings


def heard(reading: AnyReading, radio: str) -> bool:
    """Whether it is a range to a radio."""
    return isinstance(reading, Range) and reading.b == radio


def shown(readings: list[AnyReading]) -> dict[str, NodeEstimate]:
    """How everybody is shown at the end."""
    tracker = KirchhoffTracker(TrackerSettings())
    for second in range(int(readings[-1].t) + 1):
        tracker.fold([r for r in readings if int(r.t) == second])
        tracker.estimates()
    return {one.node: one for one in tracker.estimates()}


def off_and_said(one: NodeEstimate, true_m: Array) -> tuple[Array, Array]:
    """How far off somebody is shown, and what is said of it: standard deviations, east and north (m)."""
    assert one.position_m is not None
    assert one.covariance_m2 is not None
    said_m = np.sqrt([one.covariance_m2[0], one.covariance_m2[3]])
    return np.array(one.position_m[:2]) - true_m, said_m


def is_told_on_either_side(one: NodeEstimate, true_m: Array, axis: int) -> bool:
    """Whether somebody is shown where he is or at his image, across the axis, and both are open."""
    off_m, said_m = off_and_said(one, true_m)
    across_m = min(abs(off_m[axis]), abs(off_m[axis] + 2.0 * true_m[axis]))
    return bool(across_m < 3.0 and said_m[axis] > 0.5 * abs(true_m[axis]))


def after_a_unit(side: float) -> Ways:
    """One walks away to one side, by a unit that may face anything; who follows him has none."""
    return {
        "ff1": through((0.0, 3.0), (side * 40.0, 25.0)),
        "ff2": through((0.0, 1.5), (side * 40.0, 23.0)),
    }


def a_crew(side: float, turning: bool = False) -> Ways:
    """Six fan out straight to one side, by units that may face anything; then all of them may turn back."""
    ends_m = [(10.0, 30.0), (20.0, 24.0), (28.0, 16.0), (30.0, 6.0), (24.0, -4.0), (16.0, -14.0)]
    ways = {}
    for i, (east_m, north_m) in enumerate(ends_m):
        way = through((0.0, 1.0 + i), (side * east_m, north_m))[:20]
        back_m = (float(way[-1, 0]) - side * 6.0, float(way[-1, 1]) + 14.0)
        ways[f"ff{i}"] = np.concatenate([way, through((way[-1, 0], way[-1, 1]), back_m)]) if turning else way
    return ways


def across_together(side: float) -> Ways:
    """Two without units stay on the line through two radios, and leave it to the same side."""
    return {
        who: np.concatenate([resting((east_m, 0.0), 40), through((east_m, 0.0), (east_m, side * 30.0))])
        for who, east_m in (("ff1", 8.0), ("ff2", 12.0))
    }


def switched_on_beyond(side: float, *then_m: tuple[float, float]) -> Ways:
    """One without a unit leaves the line through two radios; 20 m away he switches one on, and goes on."""
    before = resting((9.0, 0.0), 30), through((9.0, 0.0), (9.0, side * 20.0))
    return {"ff1": np.concatenate([*before, through((9.0, side * 20.0), *then_m)])}


ON_S = 50


@pytest.mark.parametrize("side", SIDES)
def test_who_follows_a_unit_that_may_face_anything_may_be_on_either_side_as_he_may(side: float) -> None:
    ways = after_a_unit(side)
    found = shown(readings_of(ways, ONE, {"ff1": 0}))
    assert all(is_told_on_either_side(found[who], way[-1], 0) for who, way in ways.items())


@pytest.mark.parametrize("side", SIDES)
def test_a_whole_crew_may_be_on_either_side_of_its_radio(side: float) -> None:
    """Ranges hold all of them together: the image of one alone is contradicted by the five others."""
    ways = a_crew(side)
    found = shown(readings_of(ways, ONE, dict.fromkeys(ways, 0)))
    assert all(is_told_on_either_side(found[who], way[-1], 0) for who, way in ways.items())


@pytest.mark.parametrize("side", SIDES)
def test_a_crew_that_turns_is_on_the_side_to_which_it_turns(side: float) -> None:
    ways = a_crew(side, turning=True)
    found = shown(readings_of(ways, ONE, dict.fromkeys(ways, 0)))
    assert max(np.hypot(*off_and_said(found[who], way[-1])[0]) for who, way in ways.items()) < 3.0


@pytest.mark.parametrize("side", SIDES)
def test_another_radio_tells_the_side_of_both(side: float) -> None:
    """They began three metres beside the line through both radios: the image in it began six metres off."""
    ways = {who: np.concatenate([way, resting(way[-1], 20)]) for who, way in after_a_unit(side).items()}
    third = readings_of(ways, ONE | {"a1": (25.0, -5.0)}, {"ff1": 0})
    late_s = third[-1].t - 18.0
    found = shown([r for r in third if not heard(r, "a1") or r.t > late_s])
    for who, way in ways.items():
        off_m, said_m = off_and_said(found[who], way[-1])
        assert np.hypot(*off_m) < 3.0
        assert said_m.max() < 4.0


@pytest.mark.parametrize("side", SIDES)
def test_two_who_hear_each_other_leave_the_line_of_their_radios_to_either_side(side: float) -> None:
    ways = across_together(side)
    found = shown(readings_of(ways, TWO, {}))
    assert all(is_told_on_either_side(found[who], way[-1], 1) for who, way in ways.items())


@pytest.mark.parametrize("side", SIDES)
def test_whose_unit_is_switched_on_where_nobody_knows_his_side_may_be_on_either(side: float) -> None:
    ways = switched_on_beyond(side, (14.0, side * 35.0))
    found = shown(readings_of(ways, TWO, {"ff1": ON_S}))
    assert is_told_on_either_side(found["ff1"], ways["ff1"][-1], 1)


@pytest.mark.parametrize("side", SIDES)
def test_a_corner_to_the_left_tells_his_side(side: float) -> None:
    """Its image is one to the right, whatever the unit faces."""
    ways = switched_on_beyond(side, (14.0, side * 30.0), (30.0, side * 20.0))
    found = shown(readings_of(ways, TWO, {"ff1": ON_S}))
    off_m, said_m = off_and_said(found["ff1"], ways["ff1"][-1])
    assert np.hypot(*off_m) < 3.0
    assert said_m.max() < 5.0


def test_two_at_the_image_of_both_hear_each_other_as_they_do() -> None:
    ways = across_together(1.0)
    problem, solved = solved_of(readings_of(ways, TWO, {}))
    layout, x = problem.layout, solved.x.copy()
    for i, walk in enumerate(layout.walks):
        layout.states(x, i)[:, :2] = ways[walk.node.node][layout.grid.astype(int)]
    loose = {i: loose_steps(problem, solved, i) for i in range(2)}
    assert companions_of(problem, 0, loose) == [1]
    since = int(np.searchsorted(layout.grid, 40.0))
    alone, together = costed_images(Parts(problem, x), 0, loose, Flip(since, LINE), [1])
    assert [i for i, _ in together.flip.along] == [1]
    assert together.cost < alone.cost - 100.0
    there = apply_image(layout, x, 0, together.flip, loose)
    was, now = (layout.states(at, 0)[-1, :2] - layout.states(at, 1)[-1, :2] for at in (x, there))
    assert np.hypot(*now) == pytest.approx(np.hypot(*was), abs=1e-9)


def test_who_is_led_by_a_unit_that_knows_its_heading_goes_along_with_nobody() -> None:
    readings = readings_of(after_a_unit(1.0), ONE, {"ff1": 0})
    known = [replace(r, heading_sigma_rad=0.05) if isinstance(r, Node) else r for r in readings]
    problem, solved = solved_of(known)
    loose = {i: loose_steps(problem, solved, i) for i in range(2)}
    assert companions_of(problem, 1, {1: loose[1]}) == []


def test_those_who_change_sides_together_are_one_solution() -> None:
    problem, solved = solved_of(readings_of(across_together(1.0), TWO, {}))
    modes = likeliest_image(problem, solved).modes
    both = [mode for mode in modes if len(mode.images) == 2]
    assert len(both) == 1
    assert both[0].share == pytest.approx(0.5, abs=0.1)


def test_who_is_on_the_line_just_now_leaves_it_to_the_side_of_those_who_changed_sides_with_him() -> None:
    problem, solved = solved_of(readings_of(across_together(1.0), TWO, {}))
    layout, x = problem.layout, solved.x
    one, other = (walk.number for walk in layout.walks)
    together = Mode(one, 0.5, x.copy(), 40.0, LINE, {one: LINE, other: LINE})
    found = alternatives_now(layout, x, [together, together._replace(images={one: LINE})])
    for who in ("ff1", "ff2"):
        (kept,) = found[who]
        assert kept.image.matrix == pytest.approx(LINE.matrix)


@given(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
def test_a_turn_of_a_whole_way_is_told_anew_about_where_the_way_begins(by_rad: float, now_rad: float) -> None:
    assume(min(abs(by_rad), abs(now_rad)) > 0.1)
    start_m = np.array([7.0, -3.0])
    found = faced(facing(start_m, by_rad), now_rad)
    assert found.of(start_m) == pytest.approx(start_m, abs=1e-6)
    assert turns_whole(found)
    assert not turns_whole(replace(LINE, turned_rad=by_rad))
    assert faced(replace(LINE, turned_rad=by_rad), now_rad) == replace(LINE, turned_rad=now_rad)
