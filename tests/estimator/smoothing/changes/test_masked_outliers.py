"""A breadcrumb that was kicked, and whose first ranges bend the way of who passes it."""

import numpy as np
import pytest

from estimator.fusion.memory.ledger import RANGE
from estimator.fusion.memory.state import FusionState
from estimator.fusion.tick import fold_tick
from estimator.graph.chain_kernels import Integers
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.simulate import scenario
from estimator.smoothing.changes.masked_outliers import masked_place
from estimator.smoothing.changes.relocation import changed_t
from estimator.smoothing.problem.newton import Problem
from estimator.trackers.base import TrackerSettings
from estimator.trackers.lag import Lag
from tests.estimator.smoothing.windows import fused, problem_of

LAY_M, LIES_M = (4.0, 10.0), (9.0, 13.0)
PASSED_S = 14
"""When the walker has come to the end of his way, and turns; while he was there the breadcrumb was kicked."""
CRUMBS = {"b1": LAY_M, "b2": (-4.0, 3.0)}
SEED, NEAR_S, FOLDED_S, UNTIL_S = 16, 233.0, 242.0, 243.0
"""A kick in whose scenario who passes is near again at last, and bent by the breadcrumb, for so long."""


def walked(kicked: bool, odometry: bool = True) -> Problem:
    """The window of a walk north past two breadcrumbs, and back."""
    chance = np.random.default_rng(5)
    readings: list[AnyReading] = [Node(t=0.0, node="base", role="base", position_m=(0.0, -5.0, 0.0))]
    readings.append(Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.1))
    for name, place_m in CRUMBS.items():
        readings.append(Node(t=0.0, node=name, role="breadcrumb", position_m=(*place_m, 0.0), sigma_m=0.3))
    at = np.zeros(2)
    for second in range(1, 2 * PASSED_S + 1):
        step = np.array([0.2, 1.0 if second <= PASSED_S else -1.0])
        at, t = at + step, float(second)
        if odometry:
            e, n = (step + chance.normal(0.0, 0.03, 2)).tolist()
            readings.append(Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(e, n, 0.0)))
        lie = {**CRUMBS, "b1": LIES_M} if kicked and second > PASSED_S else CRUMBS
        for name, place_m in {**lie, "base": (0.0, -5.0)}.items():
            range_m = float(np.hypot(*(at - place_m)) + chance.normal(0.0, 0.05))
            readings.append(Range(t=t, a="ff1", b=name, range_m=range_m, technology="uwb", sigma_m=0.1))
    return problem_of(fused(readings))


def ranges_to(problem: Problem, name: str, since_t: float) -> Integers:
    """Ranges to a breadcrumb since an epoch."""
    pairs, number = problem.rows.pairs, problem.layout.state.nodes[name].index
    mine = (pairs[:, 2] == number) | (pairs[:, 3] == number)
    return np.flatnonzero(mine & (pairs[:, 1] == RANGE) & (pairs[:, 0] > since_t))


def test_where_all_others_fit_better_without_them_its_ranges_tell_where_it_lies() -> None:
    """And since when, along the way that they have not bent."""
    shown = scenario("kicked-breadcrumb", SEED)
    readings = sorted((r.reading for r in shown.reports if r.reading.t < UNTIL_S), key=lambda r: r.t)
    lag = Lag(TrackerSettings().lag_s, FusionState())
    lag.add([r for r in readings if r.t < FOLDED_S])
    state = lag.state().copy()
    fold_tick(state, UNTIL_S, [r for r in readings if r.t >= FOLDED_S])
    problem = problem_of(state, state.window_t, state.prior)
    solved, mine = problem.solve(problem.layout.start()), ranges_to(problem, "b3", NEAR_S)
    node = problem.layout.state.nodes["b3"]
    found = masked_place(problem, solved, node, mine)
    assert found is not None
    place, alone = found.place, found.alone
    there, beside = (shown.truth[name].position_m[-1] for name in ("b3", "b2"))
    size = problem.layout.length * problem.layout.width
    start = size + problem.layout.stands[problem.layout.state.nodes["b2"].index]
    off_m = (place.position_m - alone.x[start : start + 3])[:2] - (there - beside)[:2]
    assert np.hypot(*off_m) < 1.5
    since_t = changed_t(problem, alone, node, ranges_to(problem, "b3", 120.0), place)
    assert NEAR_S < since_t == float(problem.rows.t[mine].min())


@pytest.mark.parametrize("odometry", [True, False])
def test_a_breadcrumb_that_nobody_kicked_stays(odometry: bool) -> None:
    problem = walked(kicked=False, odometry=odometry)
    solved, mine = problem.solve(problem.layout.start()), ranges_to(problem, "b1", PASSED_S)
    assert masked_place(problem, solved, problem.layout.state.nodes["b1"], mine) is None


def test_ranges_that_are_taken_for_outliers_have_drawn_nobody() -> None:
    """And who is asked next is asked by the noise that the window was solved with."""
    problem = walked(kicked=True)
    solved, mine = problem.solve(problem.layout.start()), ranges_to(problem, "b1", PASSED_S)
    sigma = problem.rows.sigma.copy()
    assert masked_place(problem, solved, problem.layout.state.nodes["b1"], mine) is None
    assert (problem.rows.sigma == sigma).all()


def test_who_has_no_unit_goes_where_ranges_take_him_and_is_no_witness() -> None:
    problem = walked(kicked=True, odometry=False)
    solved, mine = problem.solve(problem.layout.start()), ranges_to(problem, "b1", PASSED_S)
    assert not problem.rows.held[mine].any()
    assert masked_place(problem, solved, problem.layout.state.nodes["b1"], mine) is None
