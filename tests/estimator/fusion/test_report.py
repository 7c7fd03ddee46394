"""What is told of a state: places and their covariances."""

import numpy as np
import pytest

from estimator.fusion import physics
from estimator.fusion.learned.calibration import Calibration
from estimator.fusion.memory.state import FusionState
from estimator.fusion.report import covariance_of
from estimator.graph.dense import Array
from estimator.graph.kirchhoff import Kirchhoff
from estimator.graph.variable import Variable

SCALE, PLACE = Variable("range", "uwb"), Variable("position", "ff1")
NARROW = physics.RANGE_SCALE_SIGMA


def measured(seed: int) -> tuple[Array, Array]:
    """Kirchhoff matrix and b of a place, a scale and a bias, by what some readings say of all of them."""
    chance = np.random.default_rng(seed)
    rows = chance.normal(0.0, 20.0, (12, 5))
    return rows.T @ rows, rows.T @ chance.normal(0.0, 1.0, 12) + 200.0 * rows[0]


def solved(seed: int, sigma: float) -> tuple[Array, Array, Array]:
    """Matrix, estimate and covariance with a prior of the scale of that standard deviation."""
    matrix, vector = measured(seed)
    prior = np.diag([1e-2, 1e-2, 1e-2, sigma**-2, 1.0])
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
