"""The smoothed view: a whole incident solved with everything known."""

import math
import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimator.evaluate import errors, full_covariance
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire
from estimator.simulate import paper_a, scenario
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.arbitrary import readings
from tests.estimator.walks import standing_radios, two_responders


@settings(max_examples=120, deadline=None)
@given(st.lists(readings, max_size=40))
def test_any_valid_readings_give_finite_tracks(anything: list[AnyReading]) -> None:
    for points in BatchSmoother().smooth(anything).values():
        assert np.isfinite([p.position_m for p in points]).all()
        assert np.isfinite([p.covariance_m2 for p in points]).all()


def test_the_order_of_the_readings_does_not_matter() -> None:
    walk = two_responders(40)
    shuffled = walk[:]
    random.Random(5).shuffle(shuffled)
    assert BatchSmoother().smooth(shuffled) == BatchSmoother().smooth(walk)


def test_a_track_has_a_point_at_each_whole_second_from_first_to_last_reading() -> None:
    walk = [r for r in two_responders(40) if r.t >= 0.0]
    tracks = BatchSmoother().smooth(walk)
    assert [p.t for p in tracks["ff1"]] == [float(t) for t in range(41)]
    assert [p.t for p in tracks["base"]] == [float(t) for t in range(41)]
    assert tracks["b10"][0].t == 11.0


def test_where_nobody_moves_what_stands_has_tracks_as_well() -> None:
    tracks = BatchSmoother().smooth(standing_radios())
    assert set(tracks) == {"base", "beacon", "anchor0", "anchor1", "anchor2"}
    beacon = tracks["beacon"][-1]
    off_m = np.subtract(beacon.position_m, (5.0, 4.0, 0.0))[:2]
    known = full_covariance(np.array([beacon.covariance_m2]))[0][:2, :2]
    assert off_m @ np.linalg.solve(known, off_m) < 13.8


def test_a_linear_walk_between_two_fixes_is_the_least_squares_line() -> None:
    """Displacements of equal noise between two exact fixes share their misfit evenly.

    The unit measures heights: it does not always report that nothing has changed.
    """
    walk: list[AnyReading] = [
        Node(t=0.0, node="ff1", role="responder", heading_sigma_rad=0.001),
        Position(t=0.0, node="ff1", position_m=(0.0, 0.0, 0.0), sigma_m=(0.01, 0.01, 0.01)),
        Position(t=10.0, node="ff1", position_m=(10.0, 0.0, 1.0), sigma_m=(0.01, 0.01, 0.01)),
    ]
    walk += [
        Displacement(t=float(k), from_t=k - 1.0, node="ff1", delta_m=(1.0, 0.0, 1e-6), sigma_m=0.5)
        for k in range(1, 11)
    ]
    points = BatchSmoother().smooth(walk)["ff1"]
    heights = [p.position_m[2] for p in points]
    assert np.abs(np.array(heights) - np.arange(11) / 10.0).max() < 0.01
    middle = points[5].covariance_m2[5]
    assert abs(middle - 0.5**2 * 10.0 / 4.0) < 0.05


def test_a_breadcrumb_dropped_again_elsewhere_has_a_place_for_each_drop() -> None:
    walk: list[AnyReading] = [Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0))]
    walk += [Displacement(t=float(k), node="ff1", delta_m=(1.0, 0.0, 0.0)) for k in range(1, 31)]
    walk += [Drop(t=10.0, node="b1", by="ff1"), Drop(t=20.0, node="b1", by="ff1")]
    east = {p.t: p.position_m[0] for p in BatchSmoother().smooth(walk)["b1"]}
    assert abs(east[10.0] - 10.0) < 0.2
    assert abs(east[20.0] - 20.0) < 0.2


def test_what_was_measured_to_a_breadcrumb_in_its_bearers_hand_says_nothing_of_where_it_was_dropped() -> None:
    walk: list[AnyReading] = [Node(t=0.0, node="base", role="base")]
    walk += [Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.1)]
    walk += [Node(t=0.0, node="b1", role="breadcrumb")]
    walk += [Displacement(t=float(k), node="ff1", delta_m=(1.0, 0.0, 0.0)) for k in range(1, 41)]
    walk += [Range(t=float(k), a="base", b="b1", range_m=float(k), technology="uwb") for k in range(1, 20)]
    walk += [Drop(t=20.0, node="b1", by="ff1")]
    walk += [Range(t=float(k), a="base", b="b1", range_m=20.0, technology="uwb") for k in range(21, 41)]
    place = {p.t: p.position_m for p in BatchSmoother().smooth(walk)["b1"]}
    assert abs(place[30.0][0] - 20.0) < 0.3
    tracker = KirchhoffTracker()
    tracker.fold(walk)
    assert not [n for n in tracker.take_notices() if n.code == "node_moved"]


def test_paper_a_scenario_smoothed_is_better_than_live_and_honest() -> None:
    live, smoothed = [], []
    for seed in range(3):
        scenario = paper_a.build(seed)
        truth = scenario.truth["ff1"]
        points = BatchSmoother().smooth(scenario.readings)["ff1"]
        true = truth.at(np.array([p.t for p in points]))
        covariance = full_covariance(np.array([p.covariance_m2 for p in points]))
        smoothed.append(errors(np.array([p.position_m for p in points]), true, covariance, 400.0))
        tracker, shown = KirchhoffTracker(), []
        for second in range(int(scenario.duration_s)):
            tracker.fold([r for r in scenario.readings if second < r.t <= second + 1 or r.t == second == 0])
            shown += [e for e in tracker.estimates() if e.node == "ff1" and e.position_m is not None]
        at = truth.at(np.array([e.t for e in shown]))
        covariance = full_covariance(np.array([e.covariance_m2 for e in shown]))
        live.append(errors(np.array([e.position_m for e in shown]), at, covariance, 400.0))
    assert np.mean([e.mean_percent for e in live]) < 0.55
    assert np.mean([e.mean_percent for e in smoothed]) < 0.20
    assert math.isfinite(sum(e.nees for e in smoothed))


@pytest.mark.parametrize("retired", [False, True], ids=["at work", "gone home"])
@pytest.mark.parametrize("seed", [0, 3])
def test_the_smoothed_view_shows_a_kicked_breadcrumb_where_it_lay_and_where_it_lies_since(
    seed: int, retired: bool
) -> None:
    shown = scenario("kicked-breadcrumb", seed)
    gone = [Retire(t=439.0, node=name) for name in ("ff1", "ff2", "b3") if retired]
    tracks = BatchSmoother().smooth([*shown.readings, *gone])
    track, beside = ({p.t: np.array(p.position_m) for p in tracks[name]} for name in ("b3", "b2"))
    moved = np.hypot(*(track[380.0] - track[150.0])[:2])
    assert moved == pytest.approx(np.hypot(*np.ptp(shown.truth["b3"].position_m, axis=0)[:2]), abs=0.5)
    for t in (150.0, 380.0):
        told = track[t] - beside[t]
        true = shown.truth["b3"].at(np.array([t]))[0] - shown.truth["b2"].at(np.array([t]))[0]
        # The whole map may be turned: who is followed is known to a tenth of a radian at the start.
        assert abs(np.hypot(*told[:2]) - np.hypot(*true[:2])) < 0.5


def test_the_smoothed_view_finds_what_the_first_pass_had_no_window_to_see() -> None:
    """The office's kick falls between two solutions of the first pass."""
    shown = scenario("office-fire", 10)
    kicked = next(n for n, t in shown.truth.items() if "-B" in n and np.ptp(t.position_m[:, 0]) > 1.0)
    track = {p.t: np.array(p.position_m) for p in BatchSmoother().smooth(list(shown.readings))[kicked]}
    for t in (400.0, 1100.0):
        off_m = np.hypot(*(track[t] - shown.truth[kicked].at(np.array([t]))[0])[:2])
        assert off_m < 1.0


def test_walls_that_are_met_again_for_two_hours_are_not_taken_for_a_scale_of_all_ranges() -> None:
    shown = scenario("two-hours", 0)
    found, true, covariance = [], [], []
    for name, points in BatchSmoother().smooth(list(shown.readings)).items():
        if name.startswith("ff"):
            found += [p.position_m for p in points]
            covariance += [p.covariance_m2 for p in points]
            true.append(shown.truth[name].at(np.array([p.t for p in points])))
    said = errors(np.array(found), np.concatenate(true), full_covariance(np.array(covariance)), 1000.0)
    assert said.nees < 4.0


def test_the_smoothed_view_asks_again_when_a_breadcrumb_was_kicked() -> None:
    """The first pass finds this kick five minutes late, when who passed it is already shown elsewhere."""
    shown = scenario("office-fire", 7)
    tracks = BatchSmoother().smooth(list(shown.readings))
    track = [p for p in tracks["E7-1"] if 500.0 < p.t < 720.0]
    true = shown.truth["E7-1"].at(np.array([p.t for p in track]))
    off_m = np.hypot(*(np.array([p.position_m for p in track]) - true)[:, :2].T)
    assert off_m.max() < 1.0
