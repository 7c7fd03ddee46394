"""How noisy a unit is, where a crew's others tell of it as well: they are mostly of one make.

The logarithm of a unit's variance over the usual one is what its crew's units have in common, and what it has
of its own, both Gaussian: what one of them shows is thought of the others as well, but not all of it
(decision 0130).
"""

import numpy as np

from estimator.graph.dense import Array

OWN, ALIKE = 0.5, 0.5
"""Variances of what is a unit's own, and of what a crew's units have in common, both assumed: one unit alone
differs from the usual one by a factor of 2.7 in variance, one sigma."""


def pulled(off: Array, score: Array, sure: Array) -> Array:
    """Steps of Newton's method for the logarithms of units' variances, n.

    Of what they have in common the most probable value is put in: it is gone from the score, and couples the
    second derivatives.

    Args:
        off: the logarithms, n.
        score: derivative of the log likelihood by each, n.
        sure: second derivative of its own of each, negative, n.
    """
    common = len(off) + OWN / ALIKE
    uphill = score - (off - off.sum() / common) / OWN
    bends = np.diag(sure + 1.0 / OWN) - 1.0 / (OWN * common)
    return np.asarray(np.linalg.solve(bends, uphill))
