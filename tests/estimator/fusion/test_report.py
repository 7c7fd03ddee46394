"""What is told of a state: places and their covariances."""

import numpy as np
import pytest

from estimator.estimate import Covariance6
from estimator.fusion import physics
from estimator.fusion.entering.introduce import upper_triangle
from estimator.fusion.entering.leaving import retire
from estimator.fusion.learned.calibration import Calibration
from estimator.fusion.learned.delays import Suspicion
from estimator.fusion.learned.told_places import MistoldPlace
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.report import covariance_of, estimate_of, estimates, relative
from estimator.fusion.tick import fold_tick
from estimator.graph.dense import Array
from estimator.graph.kirchhoff import Kirchhoff
from estimator.graph.variable import Variable
from estimator.measurements.retire import Retire

SCALE, PLACE = Variable("range", "uwb"), Variable("position", "ff1")
NARROW = physics.RANGE_SCALE_SIGMA


def measured(seed: int) -> tuple[Array, Array]:
    """Kirchhoff matrix and b of a place and three numbers of radios, by what readings say of all of them."""
    chance = np.random.default_rng(seed)
    rows = chance.normal(0.0, 20.0, (12, 6))
    return rows.T @ rows, rows.T @ chance.normal(0.0, 1.0, 12) + 200.0 * rows[0]


def solved(seed: int, sigma: float) -> tuple[Array, Array, Array]:
    """Matrix, estimate and covariance with a prior of the scale of that standard deviation."""
    matrix, vector = measured(seed)
    prior = np.diag([1e-2, 1e-2, 1e-2, sigma**-2, 1.0, 1.0])
    whole = matrix + prior
    return whole, np.asarray(np.linalg.solve(whole, vector)), np.asarray(np.linalg.inv(whole))


@pytest.mark.parametrize("share", [0.0, 0.05, 0.24])
@pytest.mark.parametrize("seed", range(5))
def test_a_picture_holds_both_kinds_of_a_scale_each_as_likely_as_it_is(seed: int, share: float) -> None:
    """Against the mixture of two whole solutions, one with each prior."""
    matrix, x, covariance = solved(seed, NARROW)
    _, other, unsure = solved(seed, physics.RANGE_SCALE_WIDE)
    state = FusionState()
    state.graph = Kirchhoff.of([PLACE, SCALE], matrix, matrix @ x * 0.0, x)
    state.calibrations["uwb"] = Calibration(share, NARROW, NARROW)
    off = other - x
    mixture = (1.0 - share) * covariance + share * (unsure + np.outer(off, off))
    assert covariance_of(state) == pytest.approx(mixture, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_a_picture_holds_that_a_told_place_may_be_wrong(seed: int) -> None:
    """Against the mixture of two whole solutions: its place told surely, and hardly."""
    anchor, share, told_m = Variable("position", "a"), 0.3, np.array([2.0, -1.0])
    chance = np.random.default_rng(seed)
    rows = chance.normal(0.0, 2.0, (9, 6))
    matrix, vector = rows.T @ rows, rows.T @ chance.normal(0.0, 3.0, 9)
    found = []
    for sigma_m in (0.1, physics.MISTOLD_SIGMA_M):
        known = np.array([sigma_m**-2, sigma_m**-2, 0.0, 0.0, 0.0, 0.0])
        covariance = np.linalg.inv(matrix + np.diag(known))
        x = covariance @ (vector + known * np.array([*told_m, 0.0, 0.0, 0.0, 0.0]))
        found.append((matrix + np.diag(known), x, covariance))
    (whole, x, covariance), (_, other, unsure) = found
    state = FusionState()
    state.graph = Kirchhoff.of([anchor, PLACE], whole, whole @ x * 0.0, x)
    state.nodes["a"] = NodeState(node="a", role="anchor", mode="static", t=0.0)
    off_m = (other - x)[:2]
    moment = share * (np.outer(off_m, off_m) + unsure[:2, :2] - covariance[:2, :2])
    state.mistold["a"] = MistoldPlace(*moment[[0, 0, 1], [0, 1, 1]].tolist())
    mixture = (1.0 - share) * covariance + share * (unsure + np.outer(other - x, other - x))
    assert covariance_of(state) == pytest.approx(mixture, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_a_picture_holds_the_delay_that_a_radio_may_have(seed: int) -> None:
    """Against a whole solution that has the delay as one more unknown, which readings see as the bias."""
    matrix, x, covariance = solved(seed, NARROW)
    sigma_m, seen = 0.7, measured(seed)[0][:, 4]
    moved = -covariance @ seen
    scale, bias_m, _ = (sigma_m * moved[3:]).tolist()
    state = FusionState()
    state.graph = Kirchhoff.of([PLACE, SCALE], matrix, matrix @ x * 0.0, x)
    state.nodes["ff1"] = NodeState(node="ff1", role="responder", t=0.0, mode="static")
    state.suspects["uwb", "ff1"] = Suspicion({"uwb": (scale, bias_m + sigma_m)}, alone=True)
    assert covariance_of(state) == pytest.approx(covariance)
    state.nodes["ff1"] = NodeState(node="ff1", role="responder", t=0.0, mode="free")
    expected = covariance + sigma_m**2 * np.outer(moved, moved)
    assert covariance_of(state)[:3, :3] == pytest.approx(expected[:3, :3], rel=1e-6, abs=1e-12)


def turned(sigma_rad: float) -> FusionState:
    """Two have walked by units that may be turned, and what tells their turns tells their heights too."""
    state = FusionState()
    for name, way_m, climbed_m in (("ff1", (20.0, 0.0), 0.4), ("ff2", (-5.0, 11.0), -0.3)):
        node = NodeState(node=name, role="responder", t=20.0, mode="unit")
        state.graph.add_node(node.position, (*way_m, 0.0), (1e3, 1e3, 1e3))
        state.graph.add_node(node.unit, (0.0, 0.0, 0.0), (sigma_rad, 1e-3, 0.02))
        state.nodes[name] = node
        start, turn = state.graph.starts[node.position], state.graph.starts[node.unit]
        columns = np.column_stack([start + np.arange(3), np.full(3, turn)])
        slopes = np.column_stack([np.ones(3), [way_m[1], -way_m[0], -climbed_m]])
        state.graph.add_measurements(columns, slopes, np.full(3, 0.1**-2), np.zeros(3))
    return state


def matrix_of(told: Covariance6 | None) -> Array:
    assert told is not None
    ee, en, eu, nn, nu, uu = told
    return np.array([[ee, en, eu], [en, nn, nu], [eu, nu, uu]])


@pytest.mark.parametrize("sigma_rad", [0.2, 1.0, np.pi, 13.0])
def test_what_is_shown_is_a_covariance_however_a_height_is_known_by_the_heading(sigma_rad: float) -> None:
    state = turned(sigma_rad)
    covariance = covariance_of(state)
    for estimate in estimates(state, covariance):
        told = matrix_of(estimate.covariance_m2)
        assert np.linalg.eigvalsh(told)[0] > 1e-3
        # His height is told as before, and goes with his place as a sine goes with its angle.
        rows, turn = (state.graph.starts[Variable(k, estimate.node)] for k in ("position", "unit"))
        linear = covariance[rows : rows + 3, rows : rows + 3]
        assert told[2, 2] == linear[2, 2]
        assert told[:2, 2] == pytest.approx(np.exp(-0.5 * covariance[turn, turn]) * linear[:2, 2], abs=1e-9)
    between = relative(state, covariance, "ff1", "ff2")
    assert between is not None
    assert np.linalg.eigvalsh(matrix_of(between.covariance_m2))[0] > 1e-3


def test_who_is_retired_or_shown_from_a_sure_place_is_as_unsure_as_before() -> None:
    state = turned(np.pi)
    state.nodes["base"] = NodeState(node="base", role="base", t=0.0, mode="fixed", place_m=(0.0, 0.0, 0.0))
    covariance = covariance_of(state)
    before = estimates(state, covariance)[0].covariance_m2
    from_base = relative(state, covariance, "base", "ff1")
    retire(state, Retire(t=21.0, node="ff1"), estimate_of(state, "ff1"))
    after = estimates(state, covariance_of(state))[0].covariance_m2
    assert from_base is not None
    assert from_base.covariance_m2 == pytest.approx(before)
    assert after == pytest.approx(before)


def test_who_is_retired_is_as_unsure_as_a_doubted_scale_had_made_him() -> None:
    matrix, x, covariance = solved(0, NARROW)
    state = FusionState()
    state.graph = Kirchhoff.of([PLACE, SCALE], matrix, matrix @ x * 0.0, x)
    state.nodes["ff1"] = NodeState(node="ff1", role="beacon", t=0.0, mode="static")
    state.calibrations["uwb"] = Calibration(0.24, NARROW, NARROW)
    before = matrix_of(estimates(state, covariance_of(state))[0].covariance_m2)
    assert np.trace(before) > 1.1 * np.trace(covariance[:3, :3])
    fold_tick(state, 1.0, [Retire(t=0.5, node="ff1")])
    assert state.nodes["ff1"].mode == "retired"
    after = estimates(state, covariance_of(state))[0].covariance_m2
    assert matrix_of(after) == pytest.approx(before)


def test_who_knows_his_heading_is_shown_as_the_matrix_has_him() -> None:
    state = turned(0.05)
    covariance = covariance_of(state)
    for estimate in estimates(state, covariance):
        rows = state.graph.rows(Variable("position", estimate.node))
        assert estimate.covariance_m2 == upper_triangle(covariance[rows, rows])
