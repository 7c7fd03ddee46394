"""Steps of PDR units as one transition of the Kirchhoff state."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.learned.gait import KEPT
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.dead_reckoning import drift_units, walk, walked
from estimator.fusion.tick import fold_tick
from estimator.graph.dense import Array
from estimator.graph.kirchhoff import Kirchhoff
from estimator.graph.variable import Variable
from estimator.measurements.node import Node
from tests.estimator.trackers.entry import BASE, step

NAMES = ("a", "b")


def crew() -> Kirchhoff:
    """Two units that face different ways, known to each other."""
    graph, chance = Kirchhoff(), np.random.default_rng(1)
    for i, name in enumerate(NAMES):
        graph.add_node(Variable("position", name), (3.0 * i, 1.0, 0.0), (0.5, 0.5, 0.5))
        graph.add_node(Variable("unit", name), (0.3 + i, 0.01, 0.02), (0.1, 0.01, 0.02))
    rows = np.tile(np.arange(12), (4, 1))
    graph.add_measurements(rows, chance.normal(0.0, 1.0, (4, 12)), np.ones(4), np.ones(4))
    return graph


def steps_of(graph: Kirchhoff) -> Array:
    """Both walk for a second."""
    starts = [(graph.starts[Variable("position", n)], graph.starts[Variable("unit", n)]) for n in NAMES]
    noise = (0.01, 0.01, 0.01, 1e-4, 1e-6, 1e-5)
    return np.array([(*at, 1.0, 0.5 * at[0], 0.1, 1.0, *noise, 0.0, 0.0) for at in starts])


def test_units_walk_in_one_transition_as_any_moving_nodes_do() -> None:
    one, other = crew(), crew()
    rows, kernel = np.empty(12, dtype=np.intp), np.empty((12, 12))
    assert walk(steps_of(one), *one.storage(), one.size, rows, kernel)
    other.advance(*walked(steps_of(other), other.reference))
    assert rows.tolist() == list(range(12))
    assert one.reference == pytest.approx(other.reference, abs=1e-12)
    assert one.information == pytest.approx(other.information, rel=1e-12)
    assert one.solve() == pytest.approx(other.solve(), abs=1e-9)


def test_whose_gait_changes_has_another_scale() -> None:
    """What was known of the one before tells next to nothing of it, and the covariance says so as well."""
    graph, scale = crew(), 5
    steps, before = steps_of(graph), graph.covariance()
    steps[0, 11] = 0.1**2
    was = graph.solve()[scale]
    assert walk(steps, *graph.storage(), graph.size, np.empty(12, dtype=np.intp), np.empty((12, 12)))
    assert graph.solve()[scale] == pytest.approx(KEPT * was, abs=1e-9)
    after = graph.covariance()
    assert after[scale, scale] == pytest.approx(0.1**2 + KEPT**2 * before[scale, scale])
    assert after[scale + 6, scale + 6] == pytest.approx(before[scale + 6, scale + 6] + 1e-5)


def test_a_gait_that_shows_late_is_reckoned_as_one_that_shows_at_once() -> None:
    """Eight steps of a crawl that turns: its scale is renewed before them, or with the last; mean and all."""
    at_once, late, still = alone(), alone(), np.zeros(2)
    turned = np.linspace(0.0, 2.0, 8)
    steps_m = 0.4 * np.column_stack([np.cos(turned), np.sin(turned)])
    crawl2 = physics.CRAWL_SCALE_SIGMA**2
    taken(at_once, still, crawl2, still)
    for delta_m in steps_m:
        taken(at_once, delta_m, 0.0, still)
    for delta_m in steps_m[:-1]:
        taken(late, delta_m, 0.0, still)
    taken(late, steps_m[-1], crawl2, steps_m.sum(axis=0))
    taken(late, still, 0.0, still)
    assert late.solve() == pytest.approx(at_once.solve(), abs=1e-6)
    np.testing.assert_allclose(late.covariance(), at_once.covariance(), rtol=1e-3, atol=3e-5)


def alone() -> Kirchhoff:
    """One unit, whose gyro is not off, and who has been told something of its place and its errors."""
    graph, chance = Kirchhoff(), np.random.default_rng(2)
    graph.add_node(Variable("position", "a"), (3.0, 1.0, 0.0), (0.5, 0.5, 0.5))
    graph.add_node(Variable("unit", "a"), (0.3, 0.0, 0.02), (0.1, 1e-3, 0.02))
    rows = np.tile(np.arange(6), (4, 1))
    jacobian = chance.normal(0.0, 1.0, (4, 6)) * [1.0, 1.0, 1.0, 1.0, 0.0, 1.0]
    graph.add_measurements(rows, jacobian, np.zeros(4), np.ones(4))
    return graph


def taken(graph: Kirchhoff, delta_m: Array, scale2: float, changed_m: Array) -> None:
    """One step of `alone`, which is exact but for its scale."""
    noise = (*(1e-6,) * 3, 1e-8, 1e-10, 1e-8 + scale2)
    steps = np.array([(0, 3, *delta_m, 0.0, 1.0, *noise, *changed_m)])
    assert walk(steps, *graph.storage(), graph.size, np.empty(6, dtype=np.intp), np.empty((6, 6)))


def test_a_transition_that_rounding_has_spoilt_is_left_to_be_done() -> None:
    graph = crew()
    matrix, vector, reference = graph.storage()
    matrix[:12, :12] = -1e9 * np.eye(12)
    rows, kernel = np.empty(12, dtype=np.intp), np.empty((12, 12))
    assert not walk(steps_of(graph), matrix, vector, reference, graph.size, rows, kernel)
    graph.loosen(rows, kernel)
    assert np.isfinite(graph.information).all()


def test_a_silent_units_frame_turns_on_as_its_gyro_is_off() -> None:
    state, bias_radps, silent_s = FusionState(), 0.002, 100.0
    node = Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), heading_sigma_rad=0.01)
    fold_tick(state, 0.5, [BASE, node])
    for second in range(1, 61):
        told = replace(step(float(second), (0.0, 0.0, 0.0)), heading_rad=-bias_radps * second)
        fold_tick(state, float(second), [told])
    heading, row = state.nodes["ff1"].unit, state.graph.starts[state.nodes["ff1"].unit]
    before_rad, told_radps, _ = state.graph.value(heading).tolist()
    before = state.graph.covariance()[row, row]
    drift_units(state, {"ff1": 60.0 + silent_s})
    assert told_radps == pytest.approx(bias_radps, rel=0.2)
    assert state.graph.value(heading)[0] - before_rad == pytest.approx(told_radps * silent_s, rel=0.01)
    assert state.graph.covariance()[row, row] > before + 1e-4
