"""What a distance that is hardly known does to a power, which falls with its logarithm.

A linear state knows the logarithm by its slope at the estimate. Who may be anywhere within tens of metres of
a radio, and is thought to be beside it, would be known to a metre by one power, for there the logarithm is
steep; at the next second by another one, elsewhere. So to a power's own noise is added by how much the
logarithm and its tangent differ over what the state leaves open, as `range_curvature` does for ranges
(García-Fernández, Svensson, Morelande, Särkkä 2015, eq. 11), with both deviations taken as independent.
"""

import numpy as np
from numba import njit

from estimator.graph.dense import Array, Indices
from estimator.measurements.rssi import DB_PER_NEPER

LEAST_EXPONENT = 0.5
"""Of nothing that spreads: the free space has 2, a corridor 1.4."""
NOWHERE = 1e-9
"""Right above or below a radio, or on it, there is no direction aside."""


@njit(cache=True, error_model="numpy")
def sight_offsets(
    columns: Indices, jacobian: Array, x: Array, aside: Array, farther: Array, slopes_db: Array
) -> None:
    """How far aside of the line of sight, and how much farther, places lead, over its length.

    Args:
        columns: which numbers each of m powers depends on, m × 9.
        jacobian: its derivatives by them, m × 9.
        x: the estimate, n.
        aside: takes the derivatives of what is aside on the ground plane, over the length, m × 9 (1/m).
        farther: takes those of the length, over the length, m × 9 (1/m).
        slopes_db: takes what a power falls by with the natural logarithm of the length, m (dB); nil where it
            does not count, as of radios that lie on each other.
    """
    aside[:], farther[:], slopes_db[:] = 0.0, 0.0, 0.0
    for r in range(len(columns)):
        first, exponent = 0 if columns[r, 0] >= 0 else 3, columns[r, 7]
        east, north, up = jacobian[r, first], jacobian[r, first + 1], jacobian[r, first + 2]
        level = np.hypot(east, north)
        if exponent < 0 or jacobian[r, 6] == 0.0 or level < NOWHERE:
            continue
        slopes_db[r] = DB_PER_NEPER * max(x[exponent], LEAST_EXPONENT)
        over = np.hypot(level, up) / slopes_db[r]
        for c in range(6):
            farther[r, c] = jacobian[r, c] / slopes_db[r]
        for start, sign in ((0, 1.0), (3, -1.0)):
            if columns[r, start] >= 0:
                aside[r, start] = -sign * north / level * over
                aside[r, start + 1] = sign * east / level * over


@njit(cache=True, error_model="numpy")
def logarithm_error(aside: float, farther: float) -> float:
    """E (½ ln ((1 + ρ)² + ψ²) − ρ)²: what the logarithm of a length is off its tangent by, squared.

    Of small variances v it is about ¾ v² of ψ and v² of ρ. Of a wide ψ it grows as slowly as the logarithm
    does, of a wide ρ as v: of the line nothing is left. Right within a factor of about two.

    Args:
        aside: variance of ψ, over the length.
        farther: variance of ρ, over the length.
    """
    return float(0.25 * np.log(1.0 + np.sqrt(3.0) * aside) ** 2 + farther**2 / (1.0 + farther))
