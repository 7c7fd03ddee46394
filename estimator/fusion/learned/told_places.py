"""Places that were told of what stands, and may be wrong: a plan misread, an anchor put elsewhere."""

import msgspec
import numpy as np

from estimator.graph.dense import Array


class MistoldPlace(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """That something may stand elsewhere than it was told to.

    Second moment about where it is thought to be, beyond its covariance there.

    Attributes:
        ee_m2: of east (m²).
        en_m2: of east and north (m²).
        nn_m2: of north (m²).
    """

    ee_m2: float
    en_m2: float
    nn_m2: float

    @property
    def moment_m2(self) -> Array:
        """As a matrix, 2 × 2 (m²)."""
        return np.array([[self.ee_m2, self.en_m2], [self.en_m2, self.nn_m2]])
