"""Readings whose time or name is wrong: it is said whose, and nobody is shown elsewhere with certainty."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.estimate import Notice
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node, Role
from estimator.measurements.range import Range
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE, outside

SECONDS, FROM_S, SEEDS = 150, 60, (61, 62, 63)
RANGE_SIGMA_M, ECHOES, ECHO_M = 0.15, 0.03, 3.0
NOTICED_S, TURNS_S = 15, 40
"""So long it takes to see that ways part, and to see some corners."""
Ways = dict[str, Array]
Carried = Callable[[Ways], Ways]


class World(NamedTuple):
    """What was measured, in order of arrival, and where everybody was at each whole second (m)."""

    readings: list[tuple[float, AnyReading]]
    ways: Ways


def as_they_are(ways: Ways) -> Ways:
    return ways


def left(ways: Ways) -> Ways:
    """What ff0 carries is left lying."""
    lies = ways["ff0"].copy()
    lies[FROM_S:] = lies[FROM_S]
    return ways | {"ff0": lies}


def left_for_a_while(ways: Ways) -> Ways:
    back = ways["ff0"].copy()
    back[FROM_S : FROM_S + 30] = back[FROM_S]
    return ways | {"ff0": back}


def exchanged(ways: Ways) -> Ways:
    """What both carry is taken for each other's."""
    one, other = ways["ff0"].copy(), ways["ff1"].copy()
    one[FROM_S:], other[FROM_S:] = ways["ff1"][FROM_S:], ways["ff0"][FROM_S:]
    return {"ff0": one, "ff1": other}


def world(
    seed: int,
    late_s: float = 0.0,
    radios: Carried = as_they_are,
    units: Carried = as_they_are,
    twins: Mapping[str, tuple[float, float]] | None = None,
    before_s: float = 0.5,
) -> World:
    """Two walk from goal to goal, and rest at some, among four radios whose places are known.

    Args:
        seed: of all chance.
        late_s: by how much ranges are stamped late.
        radios: where those go that bear their names.
        units: where their units go.
        twins: where another radio of a name lies from `FROM_S` on: east, north (m).
        before_s: so long before each whole second ranges are measured.
    """
    chance = np.random.default_rng(seed)
    anchors = {f"a{i}": chance.uniform(-25.0, 25.0, 2) for i in range(4)}
    ways = {f"ff{i}": _way(chance) for i in range(2)}
    told: list[tuple[float, AnyReading]] = [(0.0, _node(name, "anchor", at)) for name, at in anchors.items()]
    for name, way in ways.items():
        told.append((0.0, _node(name, "responder", way[0])))
        by_radio, by_unit, turned = radios(ways)[name], units(ways)[name], 0.0
        for second in range(1, SECONDS):
            turned += chance.normal(0.0, 0.005)
            cos, sin = np.cos(turned), np.sin(turned)
            step = np.array([[cos, -sin], [sin, cos]]) @ (by_unit[second] - by_unit[second - 1])
            east, north = (step + chance.normal(0.0, 0.03, 2)).tolist()
            told.append(
                (
                    second,
                    Displacement(
                        t=float(second), from_t=float(second - 1), node=name, delta_m=(east, north, 0.0)
                    ),
                )
            )
            t = second - before_s
            at = (1.0 - before_s) * by_radio[second] + before_s * by_radio[second - 1]
            places = [at, *([np.array(twins[name])] if twins and name in twins and second > FROM_S else [])]
            for place in places:
                told += [
                    (t, _ranged(chance, t + late_s, name, anchor, place - to))
                    for anchor, to in anchors.items()
                ]
    return World(sorted(told, key=lambda one: one[0]), ways)


def _node(name: str, role: Role, at: Array) -> Node:
    east, north = at.tolist()
    return Node(
        t=0.0, node=name, role=role, position_m=(east, north, 0.0), sigma_m=0.2, heading_sigma_rad=0.05
    )


def _ranged(chance: np.random.Generator, t: float, a: str, b: str, off_m: Array) -> Range:
    echo_m = chance.exponential(ECHO_M) if chance.random() < ECHOES else 0.0
    range_m = float(np.hypot(*off_m)) + echo_m + float(chance.normal(0.0, RANGE_SIGMA_M))
    return Range(t=max(t, 0.0), a=a, b=b, range_m=abs(range_m), technology="uwb")


def _way(chance: np.random.Generator) -> Array:
    at = goal = chance.uniform(-3.0, 3.0, 2)
    rest_s, way = 0, [at]
    while len(way) < SECONDS:
        if rest_s > 0:
            rest_s -= 1
        elif np.hypot(*(goal - at)) < 1.0:
            goal, rest_s = chance.uniform(-18.0, 18.0, 2), int(chance.integers(0, 5))
        else:
            at = at + (goal - at) / float(np.hypot(*(goal - at)))
        way.append(at)
    return np.array(way)


class Followed(NamedTuple):
    """For how many seconds each is shown elsewhere with certainty; how far off (m), and said of whom."""

    wrong: dict[str, int]
    off_m: dict[str, list[float]]
    notices: list[Notice]

    def said(self, text: str) -> set[str | None]:
        return {notice.node for notice in self.notices if text in notice.text}


def followed(told: World, tracker: KirchhoffTracker | None = None) -> Followed:
    tracker = tracker or KirchhoffTracker()
    wrong, off_m = dict.fromkeys(told.ways, 0), {name: list[float]() for name in told.ways}
    for second in range(SECONDS):
        tracker.fold([reading for t, reading in told.readings if second - 1 < t <= second])
        for found in tracker.estimates():
            if found.node in told.ways and second > 0 and found.position_m is not None:
                true_m = told.ways[found.node][second]
                wrong[found.node] += outside(found.position_m, found.covariance_m2, true_m) > SURE
                off_m[found.node].append(float(np.hypot(*(np.array(found.position_m[:2]) - true_m))))
    return Followed(wrong, off_m, tracker.take_notices())


@pytest.mark.parametrize("late_s", [2.0, -2.0, 1.0])
def test_ranges_by_another_clock_are_put_where_they_belong(late_s: float) -> None:
    for seed in SEEDS:
        found = followed(world(seed, late_s))
        assert found.said("are stamped") == {"ff0", "ff1"}
        assert max(found.wrong.values()) < TURNS_S
        assert all(np.mean(off_m[-50:]) < 0.5 for off_m in found.off_m.values())


@pytest.mark.parametrize("before_s", [0.3, 0.6])
@pytest.mark.parametrize("up", [False, True], ids=["down", "up"])
def test_ranges_whose_epochs_are_rounded_to_whole_seconds_are_put_where_they_belong(
    before_s: float, up: bool
) -> None:
    """Nothing disagrees enough to be an outlier: turns alone tell."""
    for seed in SEEDS:
        found = followed(world(seed, before_s if up else before_s - 1.0, before_s=before_s))
        assert found.said("in whole seconds") == {"ff0", "ff1"}
        assert max(found.wrong.values()) < NOTICED_S
        assert all(np.mean(off_m[TURNS_S:]) < 0.3 for off_m in found.off_m.values())


def lossy(told: World, chance: np.random.Generator) -> World:
    """One in five displacements is lost."""
    kept = [one for one in told.readings if not isinstance(one[1], Displacement) or chance.random() > 0.2]
    return told._replace(readings=kept)


def long_steps(told: World, _chance: np.random.Generator) -> World:
    """Units think that steps are longer by a tenth."""

    def longer(reading: AnyReading) -> AnyReading:
        if not isinstance(reading, Displacement):
            return reading
        east, north, up = reading.delta_m
        return replace(reading, delta_m=(1.1 * east, 1.1 * north, up))

    return told._replace(readings=[(t, longer(reading)) for t, reading in told.readings])


def faultless(told: World, _chance: np.random.Generator) -> World:
    return told


@pytest.mark.parametrize("fault", [faultless, lossy, long_steps])
def test_ranges_that_are_measured_at_whole_seconds_stay_there(
    fault: Callable[[World, np.random.Generator], World],
) -> None:
    for seed in SEEDS:
        found = followed(fault(world(seed, before_s=0.0), np.random.default_rng(seed)))
        assert found.said("are stamped") == set()
        assert max(found.wrong.values()) < 5


@pytest.mark.parametrize(
    ("radios", "units", "said"),
    [(left, as_they_are, "different ways"), (as_they_are, left, "while the unit of ff0 stands")],
    ids=["a radio is left", "a unit is left"],
)
def test_who_has_left_his_radio_or_unit_is_told_and_not_surely_elsewhere(
    radios: Carried, units: Carried, said: str
) -> None:
    """Sure of the one or the other, he was shown up to thirty metres off until the end."""
    for seed in SEEDS:
        found = followed(world(seed, radios=radios, units=units))
        assert found.said(said) == {"ff0"}
        assert found.wrong["ff0"] < NOTICED_S
        assert found.wrong["ff1"] < 3


def test_who_have_taken_each_others_radios_are_told_and_not_surely_elsewhere() -> None:
    for seed in SEEDS:
        found = followed(world(seed, radios=exchanged))
        assert found.said("different ways") == {"ff0", "ff1"}
        assert max(found.wrong.values()) < NOTICED_S


def test_who_has_his_radio_again_is_shown_where_he_is() -> None:
    for seed in SEEDS:
        found = followed(world(seed, radios=left_for_a_while))
        assert found.said("together again") == {"ff0"}
        assert np.mean(found.off_m["ff0"][-20:]) < 0.5


def test_a_name_that_two_radios_answer_to_is_told_and_he_goes_with_his_unit() -> None:
    for seed in SEEDS:
        found = followed(world(seed, twins={"ff0": (10.0, -12.0)}))
        assert found.said("two radios answer") == {"ff0"}
        assert found.said("different ways") == set()
        assert found.wrong["ff0"] < 5


def test_of_good_readings_nothing_is_said() -> None:
    for seed in SEEDS:
        found = followed(world(seed))
        assert {notice.code for notice in found.notices} <= {"outlier"}
        assert max(found.wrong.values()) < 3


@pytest.mark.parametrize("told", [world(64, 2.0), world(64, radios=left)], ids=["a clock", "a radio"])
def test_a_tracker_goes_on_from_a_snapshot_as_it_would_have(told: World) -> None:
    tracker = KirchhoffTracker()
    before, after = (
        World([r for r in told.readings if (r[0] > 100.0) == late], told.ways) for late in (0, 1)
    )
    followed(before, tracker)
    other = KirchhoffTracker.restore(tracker.snapshot())
    for one in (tracker, other):
        followed(after, one)
    assert tracker.estimates() == other.estimates()
