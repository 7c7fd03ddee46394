"""Rows of readings at an estimate: what is left of them, and their derivatives once anybody asks."""

from collections.abc import Callable
from functools import cached_property

from estimator.graph.dense import Array


class Linearised:
    """Rows at an estimate.

    Args:
        residual: z − h(x) − shift, m.
        differentiate: makes the derivatives.

    Attributes:
        residual: z − h(x) − shift, m.
    """

    def __init__(self, residual: Array, differentiate: Callable[[], Array]) -> None:
        self.residual, self._differentiate = residual, differentiate

    @cached_property
    def jacobian(self) -> Array:
        """Derivatives, m × c: made when first asked for, for where a solution ends few ask."""
        return self._differentiate()
