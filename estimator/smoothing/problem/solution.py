"""What solving a window leads to."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from estimator.graph.dense import Array
from estimator.graph.robust import Weighted
from estimator.smoothing.chain.chain import Chain, Remainder
from estimator.smoothing.keyframes.walks import Motion
from estimator.smoothing.readings.linearised import Linearised


@dataclass(frozen=True, eq=False)
class Solution:
    """A solved window.

    Attributes:
        x: the estimate, flat: keyframes, then the border.
        linear: its rows at the estimate.
        weighted: how each row was weighed.
        motions: the walks' motion there.
        cost: negative log likelihood up to a constant.
        rests: the last step promised next to nothing.
        stuck: the last steps promised more, but led uphill.
        assemble: makes its normal equations at the estimate.
    """

    x: Array
    linear: Linearised
    weighted: Weighted
    motions: list[Motion]
    cost: float
    rests: bool
    stuck: bool
    assemble: Callable[[], Chain]

    @cached_property
    def chain(self) -> Chain:
        """Its normal equations at the estimate, not yet solved: made when first asked for.

        Of most solutions only the cost is asked, and where they are.
        """
        return self.assemble()

    def remainder(self, keyframe: int) -> Remainder:
        """What lies before a keyframe, eliminated: see `Chain.remainder`.

        Where somebody has eliminated its equations to their end already, they are made anew.
        """
        return (self.assemble() if self.chain.reduced else self.chain).remainder(keyframe)


class Trial(NamedTuple):
    """An estimate that a step may lead to: its rows' residuals, the walks' motion there, and its cost."""

    x: Array
    residual: Array
    motions: list[Motion]
    cost: float
