"""Displacements of which nobody says since when: what their bearer walks meanwhile is lost, or told later."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.estimate import NodeEstimate
from estimator.graph.dense import Array
from estimator.measurements.displacement import Displacement
from estimator.measurements.retire import Retire
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE, SURE, outside
from tests.estimator.walks import BEGINS

SECONDS, STANDS_S = 150, 8
Reports = list[Displacement]


def walked(seed: int) -> tuple[Reports, Array]:
    """He stands at the door, then walks and turns at corners; what his unit reports, and his places."""
    chance, heading_rad = np.random.default_rng(seed), 0.0
    reports, places = [], [np.zeros(2)]
    for second in range(1, SECONDS + 1):
        heading_rad += float(chance.choice([-0.5, 0.5])) * math.pi if chance.random() < 0.06 else 0.0
        pace_m = float(chance.uniform(0.7, 1.1)) if second > STANDS_S else 0.0
        step_m = pace_m * np.array([math.cos(heading_rad), math.sin(heading_rad)])
        places.append(places[-1] + step_m)
        east, north = (step_m + chance.normal(0.0, 0.02 if pace_m else 0.001, 2)).round(3).tolist()
        faces_rad = round(heading_rad + float(chance.normal(0.0, 0.01)), 4)
        delta_m = (east, north, 0.0)
        reports.append(Displacement(t=float(second), node="ff1", delta_m=delta_m, heading_rad=faces_rad))
    return reports, np.array(places)


def shown(reports: Reports) -> list[NodeEstimate]:
    tracker, found = KirchhoffTracker(), []
    tracker.fold([BEGINS])
    for report in sorted(reports, key=lambda r: r.t):
        tracker.fold([report])
        found += tracker.estimates()
    return found


def squared_errors(reports: Reports, places: Array) -> Array:
    """Of all pictures, each at the second that it is of."""
    return np.array([outside(e.position_m, e.covariance_m2, places[int(e.t)]) for e in shown(reports)])


def each_tenth(second: int) -> bool:
    return second > 20 and second % 10 == 4


def half(second: int) -> bool:
    return second > 20 and second * 7 % 10 in (1, 3, 4, 6, 9)


def half_a_minute(second: int) -> bool:
    return 60 <= second < 90


@pytest.mark.parametrize("seed", [710, 711])
@pytest.mark.parametrize("lost", [each_tenth, half, half_a_minute])
def test_what_was_walked_in_reports_that_are_lost_is_no_part_of_the_next_one(
    lost: Callable[[int], bool], seed: int
) -> None:
    reports, places = walked(seed)
    heard = [r for r in reports if not lost(int(r.t))]
    assert squared_errors(heard, places).max() < SURE
    said = shown([replace(r, from_t=r.t - 1.0) for r in heard])
    assert shown(heard)[-1] == said[-1]


def test_who_has_never_stood_is_not_left_behind_either() -> None:
    reports, places = walked(713)
    walks = [replace(r, t=r.t - STANDS_S) for r in reports if r.t > STANDS_S and not each_tenth(int(r.t))]
    assert squared_errors(walks, places[STANDS_S:]).max() < SURE


def test_a_unit_that_says_nothing_while_its_bearer_stands_is_believed() -> None:
    """He stops and sets off within a second: what is told before and after is a part of a second's way."""
    steps = [
        Displacement(
            t=float(t), node="ff1", delta_m=(0.4 if t in (40, 60) else 0.9, 0.0, 0.0), heading_rad=0.01 * t
        )
        for t in range(1, 81)
        if not 40 < t < 60
    ]
    last = shown(steps)[-1]
    assert last.position_m is not None
    assert last.position_m[0] == pytest.approx(0.9 * 59 + 0.8, abs=1.0)


def summed_up(reports: Reports, silent: Callable[[int], bool]) -> Reports:
    """What is walked while nothing comes is in the displacement that comes next."""
    found, gone_m = [], np.zeros(3)
    for report in reports:
        gone_m = gone_m + np.array(report.delta_m)
        if not silent(int(report.t)):
            east, north, up = gone_m.tolist()
            found.append(replace(report, delta_m=(east, north, up)))
            gone_m = np.zeros(3)
    return found


@pytest.mark.parametrize("silent", [each_tenth, half_a_minute])
def test_a_unit_that_tells_later_what_was_walked_meanwhile_is_believed(silent: Callable[[int], bool]) -> None:
    reports, places = walked(710)
    told, summed = shown(reports)[-1], summed_up(reports, silent)
    found = shown(summed)[-1]
    assert told.position_m is not None
    assert found.position_m is not None
    assert math.dist(found.position_m, told.position_m) < 3.0
    assert squared_errors(summed, places).max() < SURE


def twice(reports: Reports, behind_s: float) -> Reports:
    """Two gateways hear the unit: the clock of one is behind, or its stamps are by when it heard."""
    return [*reports, *(replace(r, t=r.t + behind_s) for r in reports)]


@pytest.mark.parametrize("behind_s", [0.01, 0.4, 1.3])
def test_whom_two_gateways_hear_walks_no_faster(behind_s: float) -> None:
    reports, places = walked(710)
    alone, both = shown(reports)[-1], shown(twice(reports, behind_s))[-1]
    assert alone.position_m is not None
    assert both.position_m is not None
    assert math.hypot(*both.position_m) == pytest.approx(math.hypot(*alone.position_m), rel=0.03)
    assert outside(both.position_m, both.covariance_m2, places[-1]) < INSIDE


def test_copies_are_said_to_be_some_once() -> None:
    tracker = KirchhoffTracker()
    tracker.fold([BEGINS, *twice(walked(710)[0], 0.01)])
    assert [n.text.split(" report")[0] for n in tracker.take_notices() if n.code == "conflict"] == [
        "two gateways"
    ]


@pytest.mark.parametrize(("by_m", "by_rad"), [(0.05, 0.01), (0.1, 0.05)])
def test_a_unit_that_rounds_what_it_reports_tells_no_copies(by_m: float, by_rad: float) -> None:
    """Along a corridor it soon reports what it has reported seconds ago, heading and all."""
    chance = np.random.default_rng(713)
    reports = [
        Displacement(
            t=float(second),
            node="ff1",
            delta_m=(by_m * round(float(chance.normal(0.8, 0.08)) / by_m), 0.0, 0.0),
            heading_rad=by_rad * round(float(chance.normal(0.0, 0.01)) / by_rad),
        )
        for second in range(1, 101)
    ]
    last = shown(reports)[-1]
    assert last.position_m is not None
    assert last.position_m[0] == pytest.approx(sum(r.delta_m[0] for r in reports), rel=0.01)


@pytest.mark.parametrize("seed", range(714, 717))
def test_a_unit_that_tells_each_step_in_decimetres_loses_none(seed: int) -> None:
    """No step comes at a time of its own, and most say what another one has said, heading and all."""
    chance, t, steps = np.random.default_rng(seed), 0.0, Reports()
    for _ in range(150):
        t += float(chance.uniform(0.45, 0.75))
        east_m, north_m = (round(float(m), 1) for m in chance.normal((0.75, 0.0), 0.05))
        faces_rad = round(float(chance.normal(0.0, 0.05)), 1)
        steps.append(Displacement(t=t, node="ff1", delta_m=(east_m, north_m, 0.0), heading_rad=faces_rad))
    last = shown(steps)[-1]
    assert last.position_m is not None
    assert last.position_m[0] == pytest.approx(sum(r.delta_m[0] for r in steps), rel=0.01)


def test_a_unit_that_steps_evenly_is_not_taken_for_two() -> None:
    steps = [
        Displacement(t=0.1 * k, node="ff1", delta_m=(0.1, 0.0, 0.0), heading_rad=0.0) for k in range(100)
    ]
    last = shown(steps)[-1]
    assert last.position_m is not None
    assert last.position_m[0] == pytest.approx(10.0, abs=0.2)


def test_who_stands_while_his_unit_says_nothing_has_not_walked_on() -> None:
    """Some units report steps: none is told while their bearer stands, and none is lost by that."""
    chance, t, steps = np.random.default_rng(712), 0.0, Reports()
    for k in range(60):
        t += 20.0 if k == 40 else float(chance.uniform(0.45, 0.75))
        steps.append(Displacement(t=t, node="ff1", delta_m=(0.7, 0.0, 0.0), heading_rad=0.01 * k))
    last = shown(steps)[-1]
    assert last.position_m is not None
    assert last.position_m[0] == pytest.approx(42.0, abs=1.0)


@pytest.mark.parametrize("step_m", [0.8, 0.0])
@pytest.mark.parametrize("before", [1, 2, 4])
@pytest.mark.parametrize("silent_s", [1, 2, 5, 8, 35])
def test_reports_that_are_all_alike_after_an_early_silence_are_no_copies(
    before: int, silent_s: int, step_m: float
) -> None:
    """Who walks evenly, or stands: the silence is not the usual time between two reports."""
    epochs = [*range(1, before + 1), *range(before + 1 + silent_s, before + silent_s + 31)]
    steps = [Displacement(t=float(t), node="ff1", delta_m=(step_m, 0.0, 0.0)) for t in epochs]
    last = shown(steps)[-1]
    assert last.t == epochs[-1]
    assert last.position_m is not None
    assert last.position_m[0] >= 0.99 * step_m * len(epochs)


def test_who_walks_evenly_has_walked_all_that_came_where_three_reports_in_ten_are_lost() -> None:
    epochs = [float(second) for second in range(1, 101) if second * 7 % 10 not in (1, 3, 4)]
    last = shown([Displacement(t=t, node="ff1", delta_m=(1.0, 0.0, 0.0)) for t in epochs])[-1]
    assert last.position_m is not None
    assert last.position_m[0] >= 0.99 * len(epochs)
    assert outside(last.position_m, last.covariance_m2, np.array([100.0, 0.0])) < INSIDE


def test_what_a_unit_reports_after_its_bearer_has_left_is_said_to_be_set_aside_and_no_copy() -> None:
    steps = [Displacement(t=float(t), node="ff1", delta_m=(0.8, 0.0, 0.0)) for t in (1, 2, 3, 40, 41, 42, 43)]
    tracker = KirchhoffTracker()
    tracker.fold([BEGINS, *steps[:3], Retire(t=4.0, node="ff1")])
    for step in steps[3:]:
        tracker.fold([step])
    assert [notice.text for notice in tracker.take_notices()] == [
        "ff1 is a retired responder: its displacement is set aside"
    ]
