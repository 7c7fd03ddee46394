"""How far the bearer of a unit may have gone while it reports nothing."""

import math

from numba import njit

from estimator.fusion import physics


@njit(cache=True)
def wandered_m2(silent_s: float) -> float:
    """Variance of a way along each horizontal axis (m²): a speed that is forgotten with time.

    Nobody is anywhere at once: in a tenth of a second it grows with the square of the time, and after a few
    seconds as that of a random walk (Ornstein and Uhlenbeck 1930, of the position).

    Args:
        silent_s: time since the last report (s).
    """
    memory = physics.SILENT_MEMORY_S
    left = silent_s - memory * (1.0 - math.exp(-silent_s / memory))
    return 2.0 * physics.SILENT_SPEED_MPS**2 * memory * left
