"""Whether what is shown holds where somebody is."""

from collections.abc import Sequence

import numpy as np

from estimator.estimate import Covariance6, Vector3
from estimator.graph.dense import Array

INSIDE = 5.99
"""What 95 % of true places are within: χ² with two degrees of freedom."""
SURE = 13.8
"""What one true place in a thousand is outside of: whoever is shown so is surely shown elsewhere."""


def outside(
    position_m: Vector3 | None, covariance_m2: Covariance6 | None, true_m: Sequence[float] | Array
) -> float:
    """Squared distance of a true place from the one that is shown, in the metric of its covariance."""
    assert position_m is not None
    assert covariance_m2 is not None
    ee, en, _, nn, _, _ = covariance_m2
    off_m = np.array(position_m[:2]) - np.array(true_m[:2])
    return float(off_m @ np.linalg.solve([[ee, en], [en, nn]], off_m))
