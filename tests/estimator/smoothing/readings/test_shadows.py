"""What walls around a bearer take of all powers that he hears."""

import math
from functools import cache

import numpy as np
import pytest

from estimator.fusion import physics
from estimator.fusion.learned.noise import LearnedNoise
from estimator.graph.dense import Array
from estimator.graph.robust import mixture_cost
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.rssi import Rssi
from estimator.smoothing.problem.newton import METRES_OFF, Problem
from tests.estimator.smoothing.windows import dense, entered, fused, problem_of

AROUND_M = ((12.0, 0.0), (0.0, 12.0), (-12.0, 0.0), (0.0, -12.0))
FALL_DB = 25.0


def heard(speed_mps: float, behind_db: float = 0.0, seconds: int = 60, seed: int = 3) -> list[AnyReading]:
    """Somebody walks east, or stands, among four radios; half the time a wall takes of all of them."""
    chance = np.random.default_rng(seed)
    readings: list[AnyReading] = [entered()]
    for i, (east_m, north_m) in enumerate(AROUND_M):
        place = east_m, north_m, 0.0
        readings.append(Node(t=0.0, node=f"b{i}", role="breadcrumb", position_m=place, sigma_m=0.05))
    for second in range(1, seconds + 1):
        step = (speed_mps, 0.0, 0.0)
        readings.append(Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=step))
        for i, (east_m, north_m) in enumerate(AROUND_M):
            away_m = math.hypot(east_m - speed_mps * second, north_m)
            dbm = -50.0 - FALL_DB * math.log10(max(away_m, 0.5)) + float(chance.normal(0.0, 3.0))
            dbm -= behind_db if second > seconds / 2 else 0.0
            readings.append(Rssi(t=float(second), a="ff1", b=f"b{i}", dbm=round(dbm, 1)))
    return readings


@cache
def window(speed_mps: float = 0.2, behind_db: float = 0.0, shared: float = 0.6) -> Problem:
    """All of it, powers of a link told to have so much in common: it is not learned from so few."""
    state = fused(heard(speed_mps, behind_db))
    known = LearnedNoise(products=shared * physics.NOISE_PRIOR)
    state.noise = dict.fromkeys(state.sources, known)
    return problem_of(state)


def taken_db(problem: Problem, x: Array) -> Array:
    """What each place takes (dB): nil beforehand."""
    own = problem.rows.lying.own
    return np.asarray(-problem.rows.residual(x)[own])


def test_what_all_powers_are_too_weak_by_is_seen() -> None:
    problem = window(behind_db=10.0)
    taken = taken_db(problem, problem.solve(problem.layout.start(), METRES_OFF).x)
    half = len(taken) // 2
    assert np.mean(taken[half:]) < np.mean(taken[:half]) - 3.0
    assert np.abs(taken_db(window(), window().layout.start())).max() < 3.0


def test_what_is_taken_is_what_costs_least() -> None:
    problem = window(behind_db=10.0)
    x, rows = problem.layout.start(), problem.rows
    residual, shared = rows.residual(x), rows.lying
    for one in range(len(shared.own)):
        at = np.append(shared.rows[shared.ends[one] : shared.ends[one + 1]], shared.own[one])

        def cost(more_db: float, at: Array = at) -> float:
            off = residual[at] - more_db
            return float(mixture_cost(off, rows.sigma[at], *rows.noise[at].T.copy()).sum())

        assert cost(0.0) <= min(cost(-0.3), cost(0.3))


def test_who_stands_still_is_told_once_what_a_wall_takes() -> None:
    alike = window(speed_mps=0.0).rows.shadows.alike
    assert alike == pytest.approx(len(alike), rel=0.1)


def test_who_has_walked_a_room_on_hears_through_other_walls() -> None:
    alike = window(speed_mps=1.0).rows.shadows.alike
    kept = math.exp(-2.0 / physics.SHARED_M)
    assert alike[len(alike) // 2] == pytest.approx((1.0 + kept) / (1.0 - kept), rel=0.1)


def test_where_powers_of_a_link_have_nothing_in_common_no_place_takes_anything() -> None:
    assert len(window(shared=0.0).rows.shadows.slab) == 0


def test_the_normal_equations_are_those_of_a_window_that_asks_for_each() -> None:
    problem = window()
    x, rows, layout = problem.layout.start(), problem.rows, problem.layout
    linear, motions, shared = problem.linearise(x), problem.motions(x), rows.lying
    rows.widen(x, linear.jacobian)
    weighted = problem.weigh(linear.residual)
    size, weight = layout.length * layout.width, weighted.information
    moving = rows.slab[:, None] * layout.width + rows.columns
    at = np.where(rows.columns < layout.width, moving, size + rows.columns - layout.width)
    jacobian = np.zeros((len(at), size + layout.border + 1))
    np.put_along_axis(jacobian, np.where(rows.columns < 0, -1, at), linear.jacobian, axis=1)
    jacobian = jacobian[:, :-1]
    untold = weighted._replace(information=np.zeros_like(weight))
    expected = dense(problem.assemble(x, linear, untold, motions))[0] + jacobian.T * weight @ jacobian
    for one, own in enumerate(shared.own.tolist()):
        lying = shared.rows[shared.ends[one] : shared.ends[one + 1]]
        pulled = weight[lying] @ jacobian[lying]
        expected -= np.outer(pulled, pulled) / (weight[lying].sum() + weight[own])
    found, _ = dense(problem.assemble(x, linear, weighted, motions))
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max())


def test_a_wall_around_somebody_moves_him_nowhere() -> None:
    problem = window(speed_mps=0.0, behind_db=10.0)
    solved = problem.solve(problem.layout.start(), METRES_OFF)
    last = problem.layout.states(solved.x, 0)[-1]
    assert math.hypot(*last[:2]) < 0.5


def test_shadows_go_with_the_readings_that_lie_in_them() -> None:
    problem = window()
    rows = problem.rows
    chosen = np.ones(len(rows.t), dtype=bool)
    chosen[: len(rows.pairs)] = rows.slab[: len(rows.pairs)] < 5
    some, kept = rows.shadows.some(chosen[: len(rows.shadows.of)])
    assert some.slab.tolist() == [k for k in rows.shadows.slab.tolist() if k < 5]
    assert kept.sum() == len(some.slab)
    assert set(some.of.tolist()) == {-1, *range(len(some.slab))}


def test_half_of_what_powers_of_a_link_share_is_the_places() -> None:
    rows = window().rows
    common, at = np.full(len(rows.shadows.of), 4.0), rows.shadows.of >= 0
    left, sigma_db = rows.shadows.divided(common)
    assert left[at] == pytest.approx(2.0)
    assert left[~at] == pytest.approx(4.0)
    assert sigma_db**2 == pytest.approx(2.0 * rows.shadows.alike)
