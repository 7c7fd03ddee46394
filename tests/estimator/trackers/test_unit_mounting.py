"""Units worn the wrong way round, whose bearers drop breadcrumbs themselves (decision 0060)."""

import math

import numpy as np
import pytest

from estimator.estimate import Vector3
from estimator.fusion.entering.unit_mounting import RIGHT, Mounting
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi
from estimator.simulate import scenario
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE, outside
from tests.estimator.trackers.entry import BASE, shown

SECONDS, APART_M, CRUMBS = 120, 14.0, 5
MIRRORED, QUARTER = Mounting(True), Mounting(False, 0.5 * math.pi)
ELSEWHERE = [Mounting(False, math.radians(by_deg)) for by_deg in (40.0, -115.0)]
"""What a unit faced at first was told wrongly, by so much."""
ALL = ("ff1", "ff2", "ff3")


def entry(
    worn: Mounting, seed: int, names: tuple[str, ...] = ALL, powers: bool = False
) -> tuple[list[AnyReading], dict[str, Array]]:
    """They walk from goal to goal, two drop breadcrumbs, all range or hear these; ff1's unit is worn so."""
    chance, readings = np.random.default_rng(seed), list[AnyReading]([BASE])
    at = {name: np.array([0.0, 0.7 * i]) for i, name in enumerate(names)}
    for name, (east, north) in at.items():
        readings.append(_node(name, (float(east), float(north), 0.0)))
    goal, way, crumbs = dict(at), {name: [place] for name, place in at.items()}, dict[str, Array]()
    for second in range(1, SECONDS + 1):
        t = float(second)
        for name in names:
            if np.hypot(*(goal[name] - at[name])) < 1.0:
                goal[name] = chance.uniform(-20.0, 20.0, 2)
            off_m = goal[name] - at[name]
            step_m = off_m / max(1.0, float(np.hypot(*off_m)))
            at[name] = at[name] + step_m
            way[name].append(at[name])
            said = worn.of(*step_m) if name == "ff1" else step_m
            east, north = (np.array(said) + chance.normal(0.0, 0.03, 2)).tolist()
            readings.append(Displacement(t=t, node=name, delta_m=(east, north, 0.0)))
            dropped = sum(crumb.startswith(name) for crumb in crumbs)
            if name != "ff3" and dropped < CRUMBS and second >= APART_M * (dropped + 1):
                crumbs[f"{name}-{dropped}"] = at[name]
                readings.append(Drop(t=t, node=f"{name}-{dropped}", by=name))
        for name in names:
            for crumb, place in crumbs.items():
                off_m = float(np.hypot(*(at[name] - place)))
                if chance.random() >= 0.5:
                    continue
                if powers:
                    dbm = -45.0 - 25.0 * math.log10(max(off_m, 0.5)) + chance.normal(0.0, 4.0)
                    readings.append(Rssi(t=t, a=name, b=crumb, dbm=dbm))
                else:
                    range_m = abs(off_m + chance.normal(0.0, 0.1))
                    readings.append(Range(t=t, a=name, b=crumb, range_m=range_m, technology="uwb"))
    return readings, {name: np.array(places) for name, places in way.items()}


def _node(name: str, place_m: Vector3) -> Node:
    return Node(t=0.0, node=name, role="responder", position_m=place_m, sigma_m=0.3, heading_sigma_rad=0.05)


def followed(readings: list[AnyReading], way: dict[str, Array]) -> tuple[dict[str, int], list[str]]:
    """For how many seconds each is shown elsewhere, and sure of it; and what is said of units."""
    tracker, wrong, said = KirchhoffTracker(), dict.fromkeys(way, 0), list[str]()
    for second in range(SECONDS + 1):
        tracker.fold([r for r in readings if r.t == second])
        said += [notice.text for notice in tracker.take_notices() if "worn the wrong way" in notice.text]
        for name, places in way.items():
            found = shown(tracker, name)
            wrong[name] += outside(found.position_m, found.covariance_m2, places[second]) > SURE
    return wrong, said


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("worn", [MIRRORED, QUARTER])
def test_a_unit_worn_the_wrong_way_round_is_found_and_no_good_one_is_blamed(
    worn: Mounting, seed: int
) -> None:
    """Its bearer walks for some ten seconds before there is anything to hear."""
    wrong, said = followed(*entry(worn, seed))
    assert wrong["ff1"] < 30
    assert wrong["ff2"] + wrong["ff3"] <= 3
    assert len(said) == 1
    assert "the unit of ff1" in said[0]


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("faced", ELSEWHERE)
def test_a_heading_that_was_told_wrongly_is_found_and_no_good_unit_is_blamed(
    faced: Mounting, seed: int
) -> None:
    """What is less than a right angle off bends all of them a little, at first."""
    wrong, said = followed(*entry(faced, seed))
    assert wrong["ff1"] < 40
    assert wrong["ff2"] + wrong["ff3"] < 40
    assert len(said) == 1
    assert "the unit of ff1" in said[0]
    assert "faced elsewhere at first than was told" in said[0]


@pytest.mark.parametrize("faced", ELSEWHERE)
def test_of_two_units_that_face_apart_nobody_knows_which_was_told_wrongly_and_none_is_sure(
    faced: Mounting,
) -> None:
    """He goes on otherwise in the other solution, and his ellipse holds him there as he walks."""
    readings, way = entry(faced, 3, ("ff1", "ff2"))
    wrong, _ = followed(readings, way)
    assert wrong["ff1"] < 40
    assert wrong["ff2"] < 30
    for name, track in BatchSmoother().smooth(readings).items():
        for p in track if name in way else ():
            assert outside(p.position_m, p.covariance_m2, way[name][round(p.t)]) < SURE


def test_sharp_ranges_tell_after_a_few_steps_what_a_unit_faced() -> None:
    """Four metres among four anchors: the smoothed way is right, and no ellipse leaves him out."""
    chance, at, way = np.random.default_rng(5), np.zeros(2), [np.zeros(2)]
    corners = {"a": (-3.0, -2.0), "b": (3.0, -2.5), "c": (2.5, 3.0), "d": (-2.5, 2.5)}
    readings: list[AnyReading] = [BASE, _node("ff1", (0.0, 0.0, 0.0))]
    for name, place in corners.items():
        readings.append(Node(t=0.0, node=name, role="anchor", position_m=(*place, 0.0), sigma_m=0.05))
    for second in range(1, 15):
        step_m = 0.3 * np.array([math.cos(0.2 * second), math.sin(0.2 * second)])
        at = at + step_m
        way.append(at)
        east, north = (np.array(ELSEWHERE[1].of(*step_m)) + chance.normal(0.0, 0.01, 2)).tolist()
        readings.append(Displacement(t=float(second), node="ff1", delta_m=(east, north, 0.0)))
        for name, place in corners.items():
            range_m = math.dist(at, place) + float(chance.normal(0.0, 0.1))
            readings.append(Range(t=float(second), a="ff1", b=name, range_m=range_m, technology="uwb"))
    for p in BatchSmoother().smooth(readings)["ff1"]:
        assert math.dist(p.position_m[:2], way[round(p.t)]) < 0.5
        assert outside(p.position_m, p.covariance_m2, way[round(p.t)]) < SURE


@pytest.mark.parametrize("seed", range(2))
def test_units_worn_the_right_way_are_believed(seed: int) -> None:
    wrong, said = followed(*entry(RIGHT, seed))
    assert sum(wrong.values()) == 0
    assert said == []


def test_no_unit_is_blamed_for_what_solutions_take_for_floors() -> None:
    """One of two on a stair: whether powers go through a floor, each solution told by where it had begun."""
    tracker, coming = KirchhoffTracker(), scenario("search-night", 2010).reports
    said = list[str]()
    for second in range(1, 131):
        tracker.fold([report.reading for report in coming if second - 1 < report.sent_s <= second])
        tracker.estimates()
        said += [notice.text for notice in tracker.take_notices()]
    assert [text for text in said if "worn" in text] == []


def test_of_two_units_that_mirror_each_other_nobody_knows_which_is_wrong_and_none_is_sure() -> None:
    readings, way = entry(MIRRORED, 1, ("ff1", "ff2"))
    wrong, said = followed(readings, way)
    assert wrong["ff1"] < 40
    assert wrong["ff2"] <= 3
    assert said == []


@pytest.mark.parametrize("seed", [1, 2])
def test_powers_alone_leave_it_open_how_a_unit_is_worn(seed: int) -> None:
    readings, way = entry(MIRRORED, seed, powers=True)
    wrong, said = followed(readings, way)
    assert wrong["ff1"] < 80
    assert said == []
    for name, track in BatchSmoother().smooth(readings).items():
        for p in track if name in way else ():
            assert outside(p.position_m, p.covariance_m2, way[name][round(p.t)]) < SURE


@pytest.mark.parametrize("worn", [MIRRORED, QUARTER, *ELSEWHERE])
def test_the_smoothed_way_of_who_wears_a_unit_wrongly_is_right_from_its_beginning(worn: Mounting) -> None:
    readings, way = entry(worn, 0)
    for name, track in BatchSmoother().smooth(readings).items():
        off_m = [math.dist(p.position_m[:2], way[name][round(p.t)]) for p in track if name in way]
        assert max(off_m, default=0.0) < 1.5


def test_what_a_unit_is_found_to_be_worn_is_known_after_a_restart() -> None:
    readings, _ = entry(MIRRORED, 0)
    tracker = KirchhoffTracker()
    tracker.fold([r for r in readings if r.t <= 60.0])
    again = KirchhoffTracker.restore(tracker.snapshot())
    for one in (tracker, again):
        one.fold([r for r in readings if r.t > 60.0])
    assert again.estimates() == tracker.estimates()
