"""Encounters: a responder passes a radio, and its signal is at its strongest (paper A, section V-A).

Within 1.5 m signal strength is accurate even in fire, so such a reading is nearly a fix. It is told by
itself, a local maximum above the near threshold, and by the estimate, which must put both ends close to each
other.
"""

import numpy as np

from estimator.fusion import physics
from estimator.graph.dense import Array
from estimator.graph.kernels import strongest


def candidates(t: Array, link: Array, value: Array) -> Array:
    """Which readings are the strongest of their link within `physics.ENCOUNTER_S` before and after, m (bool).

    Args:
        t: epochs, m (s).
        link: number of the link of each, m.
        value: powers, m (dBm).
    """
    order = np.lexsort((t, link))
    found = np.zeros(len(t), dtype=bool)
    found[order] = strongest(
        t[order], link[order], value[order], physics.ENCOUNTER_S, physics.ENCOUNTER_READINGS
    )
    return found
