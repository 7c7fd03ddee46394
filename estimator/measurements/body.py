"""What a bearer's body does to a reading of his radio: how far ahead of him the other one lies."""

import numpy as np
from numba import njit

NEAR_M = 1.0
"""What is nearer is hardly ahead or behind."""


@njit(cache=True)
def ahead_of(faced_e: float, faced_n: float, east_m: float, north_m: float) -> float:
    """Cosine of the angle between where a bearer faces and where another radio lies; less of one near him.

    Args:
        faced_e: where he faces, as a unit vector; nil where nobody knows.
        faced_n: the same, north.
        east_m: way to the other radio (m).
        north_m: the same, north (m).
    """
    far_m = np.sqrt(east_m * east_m + north_m * north_m + NEAR_M * NEAR_M)
    return float((faced_e * east_m + faced_n * north_m) / far_m)
