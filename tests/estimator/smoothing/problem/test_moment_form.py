"""The filter in information form against the Kalman filter in moment form, likelihood included.

Both are given the same random linear system: two moving nodes of six numbers each beside a standing one, that
is dropped into and taken out of the graph on the way.
"""

import numpy as np
import pytest

from estimator.graph.dense import Array, Indices
from estimator.graph.kirchhoff import Kirchhoff
from estimator.graph.variable import Variable

MOVING = [Variable(kind, name) for name in ("ff1", "ff2") for kind in ("position", "velocity")]
STEPS = 40


class Moments:
    """Mean and covariance, as the textbook keeps them."""

    def __init__(self) -> None:
        self.mean: Array = np.zeros(0)
        self.covariance: Array = np.zeros((0, 0))

    def add(self, mean: Array, sigma: Array) -> None:
        n = len(self.mean)
        grown = np.zeros((n + len(mean), n + len(mean)))
        grown[:n, :n], grown[n:, n:] = self.covariance, np.diag(sigma**2)
        self.mean, self.covariance = np.concatenate([self.mean, mean]), grown

    def move(self, rows: Indices, transition: Array, noise: Array) -> None:
        whole, added = np.eye(len(self.mean)), np.zeros_like(self.covariance)
        whole[np.ix_(rows, rows)], added[np.ix_(rows, rows)] = transition, noise
        self.mean, self.covariance = whole @ self.mean, whole @ self.covariance @ whole.T + added

    def correct(self, jacobian: Array, measured: Array, variance: Array) -> float:
        """Update, and return the log likelihood of the innovation."""
        spread = jacobian @ self.covariance @ jacobian.T + np.diag(variance)
        innovation = measured - jacobian @ self.mean
        gain = self.covariance @ jacobian.T @ np.linalg.inv(spread)
        self.mean = self.mean + gain @ innovation
        rest = np.eye(len(self.mean)) - gain @ jacobian
        self.covariance = rest @ self.covariance @ rest.T + (gain * variance) @ gain.T
        weighed = float(innovation @ np.linalg.solve(spread, innovation))
        return -0.5 * (weighed + float(np.linalg.slogdet(2.0 * np.pi * spread)[1]))

    def forget(self, rows: Indices) -> None:
        kept = np.setdiff1d(np.arange(len(self.mean)), rows)
        self.mean, self.covariance = self.mean[kept], self.covariance[np.ix_(kept, kept)]


def log_determinant(graph: Kirchhoff) -> float:
    return float(np.linalg.slogdet(graph.information)[1])


def least_cost(graph: Kirchhoff) -> float:
    """The quadratic's least value below its value at the reference: −½ bᵀ L⁻¹ b."""
    return -0.5 * float(graph.vector @ np.linalg.solve(graph.information, graph.vector))


def measure(graph: Kirchhoff, jacobian: Array, measured: Array, variance: Array) -> float:
    """Update, and return the log likelihood of the readings, from determinants and costs."""
    residual = measured - jacobian @ graph.reference
    determinant, cost = log_determinant(graph), least_cost(graph)
    columns = np.tile(np.arange(graph.size), (len(measured), 1))
    graph.add_measurements(columns, jacobian, 1.0 / variance, residual)
    paid = least_cost(graph) + 0.5 * float(residual @ (residual / variance)) - cost
    spread = float(np.log(2.0 * np.pi * variance).sum())
    return -paid + 0.5 * (determinant - log_determinant(graph) - spread)


@pytest.mark.parametrize("seed", range(5))
def test_estimates_covariances_and_likelihood_are_those_of_the_kalman_filter(seed: int) -> None:
    chance = np.random.default_rng(seed)
    graph, moments = Kirchhoff(capacity=2), Moments()
    for variable in MOVING:
        mean, sigma = chance.normal(0.0, 5.0, 3), chance.uniform(0.3, 3.0, 3)
        graph.add_node(variable, mean, sigma)
        moments.add(mean, sigma)
    rows = np.arange(12).reshape(2, 6)
    likelihood = expected = 0.0
    for step in range(STEPS):
        if step % 10 == 5:
            mean, sigma = chance.normal(0.0, 5.0, 3), chance.uniform(0.3, 3.0, 3)
            graph.add_node(Variable("position", f"b{step}"), mean, sigma)
            moments.add(mean, sigma)
        if step % 10 == 9:
            gone = Variable("position", f"b{step - 4}")
            moments.forget(np.arange(12, 15))
            graph.delete_nodes([gone])
        transition = np.eye(6) + chance.normal(0.0, 0.15, (2, 6, 6))
        roots = chance.normal(0.0, 0.3, (2, 6, 6))
        noise = np.matmul(roots, roots.transpose(0, 2, 1)) + 1e-3 * np.eye(6)
        moved = np.einsum("gij,gj->gi", transition, graph.reference[rows])
        graph.advance(rows, moved, transition, noise)
        for i in (0, 1):
            moments.move(rows[i], transition[i], noise[i])
        m = int(chance.integers(1, 5))
        jacobian, variance = chance.normal(0.0, 1.0, (m, graph.size)), chance.uniform(0.05, 2.0, m)
        root = np.linalg.cholesky(moments.covariance)
        truth = moments.mean + root @ chance.normal(0.0, 1.0, graph.size)
        measured = jacobian @ truth + chance.normal(0.0, np.sqrt(variance))
        likelihood += measure(graph, jacobian, measured, variance)
        expected += moments.correct(jacobian, measured, variance)
        if step % 3 == 0:  # as the filter does between ticks: estimates must not depend on it
            graph.rebase(graph.solve())
        scale = np.sqrt(np.diagonal(moments.covariance))
        assert np.abs(graph.solve() - moments.mean).max() < 1e-8 * (1.0 + np.abs(moments.mean).max())
        off = (graph.covariance() - moments.covariance) / scale / scale[:, None]
        assert np.abs(off).max() < 1e-8
        assert likelihood == pytest.approx(expected, rel=1e-8, abs=1e-8)
