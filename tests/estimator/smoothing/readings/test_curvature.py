"""The curvature of distances against how their slopes change, at random states."""

from functools import partial

import numpy as np
import pytest

from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.graph.dense import Array
from estimator.graph.robust import Weighted
from estimator.measurements.range import predict_range
from estimator.measurements.rssi import predict_rssi
from estimator.smoothing.problem.newton import Problem
from tests.estimator.smoothing.windows import dense, difference, random_state


def bent(problem: Problem, x: Array, weight: Array, signed: bool) -> Array:
    """What the curvature of distances adds to the normal matrix, with P⁻¹ r of the pairs."""
    weighted = Weighted(np.ones(len(weight)), weight, np.ones(len(weight)))
    chain = problem.assemble(x, problem.linearise(x), weighted, problem.motions(x))
    before, _ = dense(chain)
    problem.add_curvature(chain, x, weighted, signed)
    return np.asarray(dense(chain)[0] - before)


@pytest.mark.parametrize("seed", range(3))
def test_distances_bend_as_their_slopes_change(incident: Problem, seed: int) -> None:
    """−Σ P⁻¹ r Dᵀ ∂²h/∂p² D: p is what lies between the ends, D how it changes with the unknowns."""
    chance = np.random.default_rng(seed)
    rows, layout = incident.rows, incident.layout
    x, m, size = random_state(incident, seed), len(rows.pairs), layout.length * layout.width
    # Ranges that are too long and powers that are too great bend upwards everywhere across.
    weight = np.zeros(len(rows.slab))
    kinds = rows.pairs[:, 1]
    weight[:m] = np.abs(chance.normal(0.0, 1.0, m)) * np.select([kinds == RANGE, kinds == RSSI], [-1.0, 1.0])
    expected = np.zeros((len(x), len(x)))
    changes = difference(lambda at: np.subtract(*rows.places(at)).ravel(), x).reshape(m, 3, -1)
    a, b = rows.places(x)
    heard_dbm = rows.pairs[kinds == RSSI, 4]
    for kind, predict in ((RANGE, predict_range), (RSSI, partial(predict_rssi, heard_dbm))):
        mine = np.flatnonzero(kinds == kind)
        one, two = x[size - layout.width + rows.columns[mine, 12:14]].T.copy()
        around = [np.eye(3)[c] * step for step in (1e-5, -1e-5) for c in range(3)]
        slopes = [predict(a[mine] + off_m, b[mine], one, two).by_a for off_m in around]
        curved = np.stack([(slopes[c] - slopes[3 + c]) / 2e-5 for c in range(3)], axis=-1)
        for row, curvature in zip(mine.tolist(), curved, strict=True):
            expected -= weight[row] * changes[row].T @ curvature @ changes[row]
    told = bent(incident, x, weight, signed=True)
    assert np.abs(told - expected).max() < 1e-4 * np.abs(expected).max()


@pytest.mark.parametrize("seed", range(3))
def test_far_from_the_optimum_only_what_bends_upwards_is_taken(incident: Problem, seed: int) -> None:
    weight = np.random.default_rng(seed).normal(0.0, 1.0, len(incident.rows.slab))
    told = bent(incident, random_state(incident, seed), weight, signed=False)
    eigenvalues = np.linalg.eigvalsh(told)
    assert eigenvalues[-1] > 0.0
    assert eigenvalues[0] > -1e-6 * eigenvalues[-1]
