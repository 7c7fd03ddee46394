"""What a solution says of the noise of ranges, to which the filter adds what its tangents are off by."""

import math
from collections.abc import Callable, Mapping

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.estimate import Vector3
from estimator.fusion.memory.state import FusionState
from estimator.fusion.physics import NOISE_MEMORY, RANGE_SIGMA_M
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.smoothing.learning.delay_scores import lag_one_correlation
from estimator.smoothing.learning.range_noise import explained_count, learn_ranging
from estimator.smoothing.problem.newton import METRES_OFF, Problem
from estimator.smoothing.problem.solution import Solution
from estimator.trackers import smoother
from estimator.trackers.base import TrackerSettings
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.smoothing.windows import dense, fused, problem_of

YARD_M: dict[str, Vector3] = {
    "a0": (-8.0, -6.0, 1.0),
    "a1": (8.0, -6.0, 2.0),
    "a2": (8.0, 6.0, 1.0),
    "a3": (-8.0, 6.0, 2.5),
}
VEHICLE_M: dict[str, Vector3] = {
    "a0": (0.7, 0.9, 0.5),
    "a1": (2.6, 0.9, 2.0),
    "a2": (2.6, -0.9, 2.0),
    "a3": (2.6, -0.9, 0.5),
}
SIGMA_M, SECONDS = 0.12, 120


def round_m(t: float) -> Vector3:
    """Somebody walks round at 1 m/s, his radio at his belt."""
    return 5.0 * math.cos(t / 5.0), 5.0 * math.sin(t / 5.0), 1.0


def out_and_back_m(t: float) -> Vector3:
    """Somebody walks forty metres away at 1 m/s, not quite straight, and back."""
    return 45.0 - abs(t - 40.0), 3.0 + 2.0 * math.sin(t / 8.0), 1.0


def heard(anchors: Mapping[str, Vector3], at_m: Callable[[float], Vector3], off_m: Array) -> list[AnyReading]:
    """Ranges to a walker without PDR once a second from each anchor, with errors seconds × 4 (m)."""
    readings: list[AnyReading] = [
        Node(t=0.0, node=name, role="anchor", position_m=place) for name, place in anchors.items()
    ]
    readings.append(Node(t=0.0, node="f", role="responder", position_m=at_m(0.0), sigma_m=0.5))
    for second, each in enumerate(off_m.tolist()):
        for k, (name, place) in enumerate(anchors.items()):
            t = second + 0.1 + 0.23 * k
            range_m = math.dist(at_m(t), place) + each[k]
            readings.append(Range(t=t, a="f", b=name, range_m=range_m, technology="uwb"))
    return readings


def white(seed: int) -> Array:
    """Errors that have nothing in common."""
    return np.random.default_rng(seed).normal(0.0, SIGMA_M, (SECONDS, 4))


def lasting(seed: int) -> Array:
    """Errors as large that last: each is nine tenths of the one before it on its link."""
    off_m = white(seed)
    for second in range(1, SECONDS):
        off_m[second] = 0.9 * off_m[second - 1] + math.sqrt(1.0 - 0.9**2) * off_m[second]
    return off_m


def solved_with(state: FusionState, factor: float) -> tuple[Problem, Solution]:
    """The whole incident solved by somebody who has learned a noise so many times the assumed one."""
    squares = NOISE_MEMORY * factor**2
    learned = state.learned("uwb")
    state.noise["uwb"] = replace(learned, count=NOISE_MEMORY, squares=squares, products=0.0)
    problem = problem_of(state)
    solved = problem.solve(problem.layout.start(), METRES_OFF)
    solved.chain.reduce()
    return problem, solved


@pytest.mark.parametrize("seed", range(3))
def test_ranges_that_fit_far_better_than_was_learned_are_believed(seed: int) -> None:
    state = fused(heard(YARD_M, round_m, white(seed)))
    assert learn_ranging(state, *solved_with(state, 2.0))
    assert state.learned("uwb").factor * RANGE_SIGMA_M["uwb"] == pytest.approx(SIGMA_M, rel=0.25)
    assert state.learned("uwb").count == NOISE_MEMORY


def test_what_was_learned_stays_where_a_solution_says_nearly_the_same() -> None:
    state = fused(heard(YARD_M, round_m, white(0)))
    problem, solved = solved_with(state, 1.5 * SIGMA_M / RANGE_SIGMA_M["uwb"])
    before = state.learned("uwb")
    assert not learn_ranging(state, problem, solved)
    assert state.learned("uwb") == before


@pytest.mark.parametrize("seed", range(3))
def test_errors_that_last_are_not_taken_for_small_ones(seed: int) -> None:
    """The way follows them, and what is left looks half as large: but it does not come and go by chance."""
    state = fused(heard(YARD_M, round_m, lasting(seed)))
    learn_ranging(state, *solved_with(state, 1.2 * SIGMA_M / RANGE_SIGMA_M["uwb"]))
    assert state.learned("uwb").factor == pytest.approx(1.2 * SIGMA_M / RANGE_SIGMA_M["uwb"])


def test_what_the_unknowns_take_up_of_readings_is_told_by_probing() -> None:
    """Σ w J L⁻¹ Jᵀ, beside the same by the whole inverse."""
    state = fused(heard(YARD_M, round_m, white(0)))
    problem, solved = solved_with(state, 1.0)
    layout, rows = problem.layout, problem.rows
    at = np.arange(len(rows.pairs))
    root = np.sqrt(solved.weighted.good[at]) / rows.sigma[at]
    matrix, _ = dense(problem.solve(solved.x, iterations=0).chain)
    size = layout.length * layout.width
    whole = np.zeros((len(at), len(matrix)))
    for r in at:
        for column, slope in zip(rows.columns[r], solved.linear.jacobian[r], strict=True):
            if column >= 0:
                inside = column < layout.width
                start = rows.slab[r] * layout.width if inside else size - layout.width
                whole[r, start + column] += slope
    exact = float(np.trace(np.linalg.solve(matrix, (whole * root[:, None] ** 2).T @ whole)))
    assert exact > 50.0
    assert explained_count(problem, solved, at, root) == pytest.approx(exact, rel=0.03)


def test_errors_follow_on_from_those_of_their_own_link_only() -> None:
    """One link's are all alike, the other's alternate; together they say nothing of each other."""
    links, errors = np.array([0, 1] * 4), np.array([1.0, 1.0, 1.0, -1.0] * 2)
    assert lag_one_correlation(links[links == 0], errors[links == 0]) == pytest.approx(1.0)
    assert lag_one_correlation(links[links == 1], errors[links == 1]) == 0.0
    assert lag_one_correlation(links, errors) == 0.0
    assert lag_one_correlation(np.full(3, -1), np.ones(3)) == 0.0


@pytest.mark.parametrize("seed", range(3))
def test_ellipses_are_as_small_as_rare_ranges_of_one_vehicle_allow(seed: int) -> None:
    """He walks away and comes back: by what the filter makes of the noise they would be twice as large."""
    readings = heard(VEHICLE_M, out_and_back_m, np.random.default_rng(seed).normal(0.0, 0.02, (80, 4)))
    track = smoother("kirchhoff", TrackerSettings()).smooth(readings)["f"]
    said = [math.sqrt(p.covariance_m2[0] + p.covariance_m2[3]) for p in track]
    off = [math.dist(p.position_m[:2], out_and_back_m(p.t)[:2]) for p in track]
    assert np.median(said) < 1.2
    assert (np.array(off) < 2.0 * np.array(said)).all()


@pytest.mark.parametrize("seed", range(3))
def test_who_is_heard_rarely_by_one_vehicle_is_followed_by_good_ranges(seed: int) -> None:
    """Live ellipses of 4.2 m become 3.4 m; and surer ranges make no antenna delay."""
    readings = heard(VEHICLE_M, out_and_back_m, np.random.default_rng(seed).normal(0.0, 0.02, (80, 4)))
    rarely = [r for r in readings if not isinstance(r, Range) or int(r.t) % 2 == 0]
    tracker, off, said = KirchhoffTracker(), list[float](), list[float]()
    for second in range(81):
        tracker.fold([r for r in rarely if second - 1 <= r.t < second])
        for e in tracker.estimates():
            if e.node == "f" and e.position_m is not None and e.covariance_m2 is not None:
                off.append(math.dist(e.position_m[:2], out_and_back_m(e.t)[:2]))
                said.append(math.sqrt(e.covariance_m2[0] + e.covariance_m2[3]))
    assert np.median(said) < 3.8
    assert (np.array(off) < 2.0 * np.array(said)).all()
    assert not any("antenna delay" in notice.text for notice in tracker.take_notices())
