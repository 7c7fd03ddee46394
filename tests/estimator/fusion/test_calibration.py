"""Whether a ranging technology is calibrated, from what the readings alone say of its scale and bias."""

import numpy as np
import pytest

from estimator.fusion.calibration import Kinds, of_technology, uncalibrated
from estimator.graph.dense import Array

TECHNOLOGIES = ["uwb", "ultrasound", "rtt", "a radio never heard of"]
SHARES = [0.0, 0.1, 0.5, 0.9, 1.0]


def judged(kinds: Kinds, share: float, truth: list[float], data: Array) -> float:
    """What is said of a technology when readings with information `data` (n × n) tell the truth."""
    covariance = np.asarray(np.linalg.inv(np.diag(kinds.information(share)) + data), dtype=np.float64)
    return uncalibrated(kinds, share, covariance @ data @ np.array(truth), covariance)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("technology", TECHNOLOGIES)
def test_a_scale_of_seven_percent_seen_sharply_is_not_calibrated(technology: str, share: float) -> None:
    for data in (np.diag([0.005**-2, 0.0]), np.diag([0.005**-2, 0.1**-2])):
        assert judged(of_technology(technology), share, [0.07, 0.0], data) > 0.99


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("technology", TECHNOLOGIES)
def test_a_scale_of_three_per_mille_is_calibrated(technology: str, share: float) -> None:
    for data in (np.diag([0.002**-2, 0.0]), np.diag([0.002**-2, 0.05**-2])):
        assert judged(of_technology(technology), share, [0.003, 0.0], data) < 0.2


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("technology", TECHNOLOGIES)
def test_where_nothing_is_known_the_usual_share_stays(technology: str, share: float) -> None:
    nothing = judged(of_technology(technology), share, [0.0, 0.0], np.zeros((2, 2)))
    assert nothing == pytest.approx(of_technology(technology).usual)
    little = judged(of_technology(technology), share, [0.5, 3.0], np.diag([10.0**-2, 100.0**-2]))
    assert little == pytest.approx(of_technology(technology).usual, rel=0.01)


@pytest.mark.parametrize("seed", range(20))
def test_the_answer_does_not_depend_on_the_share_that_the_estimate_was_made_with(seed: int) -> None:
    chance = np.random.default_rng(seed)
    seen = chance.normal(0.0, 1.0, (3, 2)) / np.array([0.02, 0.2])
    truth = [float(chance.normal(0.0, 0.03)), float(chance.normal(0.0, 0.3))]
    told = [judged(of_technology("uwb"), share, truth, seen.T @ seen) for share in SHARES]
    assert told == pytest.approx([told[0]] * len(SHARES), rel=1e-6)
