"""The three operations of paper A on small graphs whose answers are known."""

import gtsam
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.graph.dense import Array
from estimator.graph.kirchhoff import LINE, Kirchhoff, roomy
from estimator.graph.variable import Variable

NONE = (np.inf,) * 3


def node(name: str) -> Variable:
    return Variable("position", name)


def connect(graph: Kirchhoff, a: str | None, b: str, measured: Array, sigma: float) -> None:
    """A relative position b − a (paper A, ζ); a is None: the base, an anchor at the origin (eq. 12)."""
    end = graph.rows(node(b)).start + np.arange(3)
    if a is None:
        columns, jacobian = end[:, None], np.ones((3, 1))
        residual = measured - graph.reference[end]
    else:
        start = graph.rows(node(a)).start + np.arange(3)
        columns, jacobian = np.column_stack([end, start]), np.tile([1.0, -1.0], (3, 1))
        residual = measured - (graph.reference[end] - graph.reference[start])
    graph.add_measurements(columns, jacobian, np.full(3, sigma**-2), residual)


def paper_example() -> Kirchhoff:
    """Fig. 4: a base and three breadcrumbs in two loops, six edges."""
    chance = np.random.default_rng(3)
    graph = Kirchhoff(capacity=2)
    for name in ("1", "2", "3"):
        graph.add_node(node(name), chance.normal(0.0, 5.0, 3), NONE)
    for a, b, sigma in (
        (None, "1", 1.0),
        (None, "2", 2.0),
        ("1", "2", 0.5),
        ("2", "3", 1.0),
        ("1", "3", 2.0),
    ):
        connect(graph, a, b, chance.normal(0.0, 10.0, 3), sigma)
    connect(graph, None, "3", chance.normal(0.0, 10.0, 3), 3.0)
    return graph


def test_the_covariance_of_a_node_is_its_effective_resistance_to_the_base() -> None:
    """Base —1 Ω²— a —4— b in series, and a bridge base —5— b in parallel: R = 5·5 / (5 + 5)."""
    graph = Kirchhoff()
    graph.add_node(node("a"), np.zeros(3), NONE)
    graph.add_node(node("b"), np.zeros(3), NONE)
    connect(graph, None, "a", np.ones(3), 1.0)
    connect(graph, "a", "b", np.ones(3), 2.0)
    covariance = graph.covariance()
    rows = graph.rows(node("b"))
    assert covariance[rows, rows] == pytest.approx(5.0 * np.eye(3))
    connect(graph, None, "b", np.ones(3), np.sqrt(5.0))
    assert graph.covariance()[rows, rows] == pytest.approx(2.5 * np.eye(3))


def test_operations_build_the_matrix_of_equation_7() -> None:
    graph = paper_example()
    blocks = graph.information[::3, ::3]
    weights = {"b1": 1.0, "b2": 0.25, "12": 4.0, "23": 1.0, "13": 0.25, "b3": 1.0 / 9.0}
    expected = np.array(
        [
            [weights["b1"] + weights["12"] + weights["13"], -weights["12"], -weights["13"]],
            [-weights["12"], weights["b2"] + weights["12"] + weights["23"], -weights["23"]],
            [-weights["13"], -weights["23"], weights["23"] + weights["13"] + weights["b3"]],
        ]
    )
    assert blocks == pytest.approx(expected)


def test_marginalising_then_solving_equals_solving_whole() -> None:
    whole, reduced = paper_example(), paper_example()
    solution, covariance = whole.solve(), whole.covariance()
    reduced.delete_nodes([node("1")])
    kept = np.arange(3, 9)
    assert np.abs(reduced.solve() - solution[kept]).max() < 1e-9
    assert np.abs(reduced.covariance() - covariance[np.ix_(kept, kept)]).max() < 1e-9


def test_moving_the_point_of_linearisation_changes_nothing() -> None:
    graph = paper_example()
    before = graph.solve()
    graph.rebase(graph.reference + 1e3)
    assert np.abs(graph.solve() - before).max() < 1e-9


@given(st.integers(0, 10_000))
def test_advancing_equals_adding_a_node_and_an_edge_and_deleting_the_old_node(seed: int) -> None:
    chance = np.random.default_rng(seed)
    closed, long = paper_example(), paper_example()
    moved, spread = chance.normal(0.0, 3.0, 3), chance.uniform(0.01, 2.0, 3)
    rows = np.arange(3)[None] + closed.rows(node("2")).start
    closed.rebase(closed.solve())
    long.rebase(long.solve())
    there = long.value(node("2")) + moved
    closed.advance(rows, there[None], np.eye(3)[None], np.diag(spread**2)[None])
    later = Variable("position", "2", 1.0)
    long.add_node(later, there, NONE)
    old, new = rows[0], np.arange(3) + long.rows(later).start
    long.add_measurements(np.column_stack([new, old]), np.tile([1.0, -1.0], (3, 1)), spread**-2, np.zeros(3))
    long.delete_nodes([node("2")])
    order = np.r_[0:3, 6:9, 3:6]
    assert np.abs(closed.covariance() - long.covariance()[np.ix_(order, order)]).max() < 1e-9
    assert np.abs(closed.solve() - long.solve()[order]).max() < 1e-9


def test_the_information_form_agrees_with_a_moment_form_filter() -> None:
    """Prediction with a full Jacobian and updates, against the textbook Kalman filter on the same numbers."""
    chance = np.random.default_rng(5)
    graph = Kirchhoff()
    graph.add_node(node("p"), np.zeros(3), (1.0, 2.0, 3.0))
    graph.add_node(Variable("velocity", "p"), np.ones(3), (1.0, 1.0, 1.0))
    mean, covariance = graph.solve(), graph.covariance()
    rows = np.arange(6)[None]
    for _ in range(30):
        transition = np.eye(6)
        transition[:3, 3:] = 0.4 * np.eye(3)
        transition[3:, 3:] = 0.9 * np.eye(3)
        noise = np.diag(chance.uniform(0.01, 0.1, 6))
        graph.advance(rows, (transition @ graph.reference)[None], transition[None], noise[None])
        mean, covariance = transition @ mean, transition @ covariance @ transition.T + noise
        jacobian, measured, variance = chance.normal(0.0, 1.0, (2, 6)), chance.normal(0.0, 3.0, 2), 0.3
        columns = np.tile(np.arange(6), (2, 1))
        residual = measured - jacobian @ graph.reference
        graph.add_measurements(columns, jacobian, np.full(2, 1.0 / variance), residual)
        spread = jacobian @ covariance @ jacobian.T + variance * np.eye(2)
        gain = covariance @ jacobian.T @ np.linalg.inv(spread)
        mean = mean + gain @ (measured - jacobian @ mean)
        covariance = covariance - gain @ spread @ gain.T
        graph.rebase(graph.solve())
        assert np.abs(graph.reference - mean).max() < 1e-9
        assert np.abs(graph.covariance() - covariance).max() < 1e-9


def test_a_nonlinear_graph_relinearised_to_rest_agrees_with_gtsam() -> None:
    """Four nodes with relative positions and ranges, solved by the operations and by GTSAM's optimiser."""
    truth = np.array([[5.0, 0.0, 0.0], [9.0, 6.0, 1.0], [2.0, 8.0, 0.5], [-3.0, 4.0, 0.0]])
    chance = np.random.default_rng(11)
    names = ["1", "2", "3", "4"]
    edges = [(None, 0, 0.5), (0, 1, 0.5), (1, 2, 0.6), (2, 3, 0.7)]
    ranges = [(0, 2, 0.1), (1, 3, 0.1), (0, 3, 0.2)]
    away = {(a, b): truth[b] - (0.0 if a is None else truth[a]) for a, b, _ in [*edges, *ranges]}
    steps = {(a, b): away[a, b] + chance.normal(0.0, s, 3) for a, b, s in edges}
    dist = {(a, b): float(np.linalg.norm(away[a, b]) + chance.normal(0.0, s)) for a, b, s in ranges}
    start = truth + chance.normal(0.0, 0.5, truth.shape)

    factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    factors.add(gtsam.PriorFactorPoint3(99, np.zeros(3), gtsam.noiseModel.Isotropic.Sigma(3, 1e-9)))
    values.insert(99, np.zeros(3))
    for a, b, sigma in edges:
        noise = gtsam.noiseModel.Isotropic.Sigma(3, sigma)
        factors.add(gtsam.BetweenFactorPoint3(99 if a is None else a, b, steps[a, b], noise))
    for a, b, sigma in ranges:
        factors.add(gtsam.RangeFactor3(a, b, dist[a, b], gtsam.noiseModel.Isotropic.Sigma(1, sigma)))
    for i in range(4):
        values.insert(i, start[i])
    tight = gtsam.LevenbergMarquardtParams()
    tight.setRelativeErrorTol(1e-15)
    tight.setAbsoluteErrorTol(1e-15)
    optimum = gtsam.LevenbergMarquardtOptimizer(factors, values, tight).optimize()

    x = start.ravel()
    for _ in range(20):
        graph = Kirchhoff()
        for i, name in enumerate(names):
            graph.add_node(node(name), x[3 * i : 3 * i + 3], NONE)
        for a, b, sigma in edges:
            connect(graph, None if a is None else names[a], names[b], steps[a, b], sigma)
        for a, b, sigma in ranges:
            between = x[3 * a : 3 * a + 3] - x[3 * b : 3 * b + 3]
            length = float(np.linalg.norm(between))
            columns = np.r_[3 * a : 3 * a + 3, 3 * b : 3 * b + 3][None]
            jacobian = np.r_[between, -between][None] / length
            graph.add_measurements(columns, jacobian, np.array([sigma**-2]), np.array([dist[a, b] - length]))
        x = graph.solve()
    expected = np.concatenate([optimum.atPoint3(i) for i in range(4)])
    assert np.abs(x - expected).max() < 1e-6
    marginals = gtsam.Marginals(factors, optimum)
    covariance = graph.covariance()
    for i in range(4):
        block = covariance[3 * i : 3 * i + 3, 3 * i : 3 * i + 3]
        assert np.abs(block - marginals.marginalCovariance(i)).max() < 1e-5


def test_the_first_rows_of_a_kind_of_blocks_follow_what_enters_and_leaves() -> None:
    """A copy that goes its own way changes nothing of the original's."""
    graph = Kirchhoff()
    for name in ("a", "b"):
        graph.add_node(node(name), np.zeros(3), (1.0,) * 3)
        graph.add_node(Variable("unit", name), np.zeros(3), (1.0,) * 3)
    assert graph.firsts("unit").tolist() == [3, 9]
    twin = graph.copy()
    assert twin.numbers("position") == {node("a"): 0, node("b"): 1}
    twin.delete_nodes([node("a")])
    assert twin.firsts("unit").tolist() == [0, 6]
    assert twin.numbers("position") == {node("b"): 0}
    graph.add_node(Variable("unit", "c"), np.zeros(3), (1.0,) * 3)
    assert graph.firsts("unit").tolist() == [3, 9, 12]
    assert list(graph.numbers("unit")) == [Variable("unit", name) for name in "abc"]
    assert twin.firsts("unit").tolist() == [0, 6]
    assert graph.firsts("velocity").tolist() == []


def test_who_stands_still_does_not_turn_with_the_map() -> None:
    graph = Kirchhoff()
    for name in ("engine", "a"):
        graph.add_node(node(name), np.zeros(3), (1.0,) * 3)
    graph.add_node(Variable("unit", "a"), np.zeros(3), (1.0,) * 3)
    assert graph.turning().places.tolist() == [[0, 1], [3, 4]]
    beside = graph.turning(frozenset({"engine"}))
    assert beside.places.tolist() == [[3, 4]]
    assert beside.headings.tolist() == [6]
    graph.delete_nodes([node("a")])
    assert graph.turning(frozenset({"engine"})).places.tolist() == []


def test_copies_share_where_blocks_stand_until_one_of_them_takes_another_in() -> None:
    graph = Kirchhoff()
    graph.add_node(node("a"), np.zeros(3), (1.0,) * 3)
    twin = graph.copy()
    assert twin.starts is graph.starts
    twin.add_node(node("b"), np.zeros(3), (1.0,) * 3)
    assert list(graph.starts) == [node("a")]
    assert list(twin.starts) == [node("a"), node("b")]


def test_rows_have_room_for_an_eighth_more_and_an_odd_number_of_cache_lines() -> None:
    for size in range(1, 1000):
        assert 1.125 * size <= roomy(size) < 1.125 * size + 2 * LINE
        assert roomy(size) % (2 * LINE) == LINE
