"""Paper A's network: effective resistances, and the best linear unbiased estimate."""

from typing import NamedTuple

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.graph.variable import Variable
from estimator.paper_a.network import Network, predict_range

BASE = np.zeros(3)


def vertex(name: str, epoch: float | None = None) -> Variable:
    return Variable("position", name, epoch)


def resistance(network: Network, name: str) -> Array:
    rows = network.graph.rows(vertex(name))
    block: Array = network.covariance()[rows, rows]
    return block


def test_a_node_s_covariance_is_its_effective_resistance_to_the_base() -> None:
    """Base —1 m²— a —4 m²— b in series is 5; a second edge of 5 from base to b lies in parallel: 2.5.

    Then a sees 1 in parallel with 4 + 5, which is 0.9.
    """
    network = Network()
    network.add_node(vertex("a"), BASE, np.ones(3), (1.0,) * 3)
    network.add_node(vertex("b"), vertex("a"), np.ones(3), (2.0,) * 3)
    assert resistance(network, "a") == pytest.approx(1.0 * np.eye(3))
    assert resistance(network, "b") == pytest.approx(5.0 * np.eye(3))
    network.add_position(vertex("b"), BASE, 3.0 * np.ones(3), (5.0**0.5,) * 3)
    assert resistance(network, "b") == pytest.approx(2.5 * np.eye(3))
    assert resistance(network, "a") == pytest.approx(0.9 * np.eye(3))
    # Equal resistances on both ways to b: half of the contradiction (3 m against 2 m) for each.
    assert network.place(vertex("b")) == pytest.approx(2.5 * np.ones(3))


class Edge(NamedTuple):
    start: str | None
    end: str
    offset_m: Array
    sigma_m: float


def random_edges(chance: np.random.Generator, names: list[str]) -> list[Edge]:
    """A tree from the base over all nodes, and as many edges again, criss-cross."""
    tree: list[tuple[str | None, str]] = [
        (names[chance.integers(i)] if i else None, name) for i, name in enumerate(names)
    ]
    across = [tuple(chance.choice(names, 2, replace=False).tolist()) for _ in names]
    pairs = [*tree, *across]
    return [Edge(a, b, chance.normal(0.0, 5.0, 3), float(chance.uniform(0.1, 3.0))) for a, b in pairs]


def blue(edges: list[Edge], names: list[str]) -> tuple[Array, Array]:
    """Eq. 3 to 5 at once: x̂ and Σ of z = Aᵀ x + ε by dense least squares."""
    incidence = np.zeros((3 * len(edges), 3 * len(names)))
    for row, edge in enumerate(edges):
        at, end = 3 * row, 3 * names.index(edge.end)
        incidence[at : at + 3, end : end + 3] = np.eye(3)
        if edge.start is not None:
            start = 3 * names.index(edge.start)
            incidence[at : at + 3, start : start + 3] = -np.eye(3)
    weighted = incidence.T * np.repeat([e.sigma_m**-2 for e in edges], 3)
    covariance = np.linalg.inv(weighted @ incidence)
    return covariance @ weighted @ np.concatenate([e.offset_m for e in edges]), covariance


@pytest.mark.parametrize("seed", range(5))
def test_nodes_and_measurements_added_one_by_one_give_the_best_linear_unbiased_estimate(seed: int) -> None:
    names = list("abcdef")
    edges = random_edges(np.random.default_rng(seed), names)
    network = Network()
    for edge in edges:
        start = BASE if edge.start is None else vertex(edge.start)
        add = network.add_position if vertex(edge.end) in network.graph else network.add_node
        add(vertex(edge.end), start, edge.offset_m, (edge.sigma_m,) * 3)
    expected, covariance = blue(edges, names)
    assert network.graph.reference == pytest.approx(expected)
    assert network.covariance() == pytest.approx(covariance)


@pytest.mark.parametrize("gone", ["a", "c", "f"])
def test_deleting_a_node_changes_neither_estimate_nor_covariance_of_the_others(gone: str) -> None:
    names = list("abcdef")
    edges = random_edges(np.random.default_rng(7), names)
    network = Network()
    for edge in edges:
        start = BASE if edge.start is None else vertex(edge.start)
        add = network.add_position if vertex(edge.end) in network.graph else network.add_node
        add(vertex(edge.end), start, edge.offset_m, (edge.sigma_m,) * 3)
    network.delete_node(vertex(gone))
    expected, covariance = blue(edges, names)
    kept = np.array([3 * i + axis for i, name in enumerate(names) if name != gone for axis in range(3)])
    assert network.graph.reference == pytest.approx(expected[kept])
    assert network.covariance() == pytest.approx(covariance[np.ix_(kept, kept)])


def test_a_firefighter_whose_old_states_are_deleted_is_where_the_whole_walk_puts_him() -> None:
    """Section IV-E against one least squares over all his states: he walks, and fixes correct him."""
    chance = np.random.default_rng(2)
    edges = [Edge(None, "0", np.zeros(3), 0.5)]
    network = Network()
    network.add_node(vertex("ff", 0.0), BASE, np.zeros(3), (0.5,) * 3)
    for step in range(1, 9):
        offset = chance.normal(1.0, 1.0, 3)
        edges.append(Edge(str(step - 1), str(step), offset, 0.3))
        network.move(vertex("ff", step - 1.0), vertex("ff", float(step)), offset, (0.3,) * 3)
        if step % 3 == 0:
            fix = chance.normal(step, 1.0, 3)
            edges.append(Edge(None, str(step), fix, 1.5))
            network.add_position(vertex("ff", float(step)), BASE, fix, (1.5,) * 3)
    expected, covariance = blue(edges, [str(i) for i in range(9)])
    assert list(network.graph.starts) == [vertex("ff", 8.0)]
    assert network.place(vertex("ff", 8.0)) == pytest.approx(expected[-3:])
    assert network.covariance() == pytest.approx(covariance[-3:, -3:])


def test_a_range_adds_information_along_the_line_between_its_ends_and_nowhere_else() -> None:
    """Eq. 18 to 20: L grows by hᵀ P⁻¹ h at both ends and by −hᵀ P⁻¹ h between them."""
    network = Network()
    network.add_node(vertex("a"), BASE, np.array([1.0, 2.0, 0.0]), (1.0,) * 3)
    network.add_node(vertex("b"), BASE, np.array([4.0, 6.0, 0.0]), (1.0,) * 3)
    before = network.graph.information.copy()
    network.add_range(vertex("a"), vertex("b"), 6.0, 0.5)
    along = np.array([-0.6, -0.8, 0.0])
    block = 4.0 * np.outer(along, along)
    grown = network.graph.information - before
    assert grown == pytest.approx(np.block([[block, -block], [-block, block]]), rel=1e-3)
    # 1 m too near: variances along the line are 1, 1 and 0.25 of the range, so each end yields 1 / 2.25.
    assert network.place(vertex("a")) == pytest.approx([1.0 - 0.6 / 2.25, 2.0 - 0.8 / 2.25, 0.0], rel=1e-3)
    assert network.place(vertex("b")) == pytest.approx([4.0 + 0.6 / 2.25, 6.0 + 0.8 / 2.25, 0.0], rel=1e-3)


def test_the_derivative_of_a_range_is_that_of_finite_differences_and_finite_on_one_spot() -> None:
    difference = np.array([3.0, -7.0, 1.5])
    _, derivative = predict_range(difference)
    steps = 1e-6 * np.eye(3)
    numeric = [(predict_range(difference + s)[0] - predict_range(difference - s)[0]) / 2e-6 for s in steps]
    assert derivative == pytest.approx(numeric, rel=1e-3)
    assert predict_range(np.zeros(3))[1].tolist() == [0.0, 0.0, 0.0]
