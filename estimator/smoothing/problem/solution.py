"""What solving a window leads to."""

from typing import NamedTuple

from estimator.graph.dense import Array
from estimator.graph.robust import Weighted
from estimator.smoothing.chain.chain import Chain
from estimator.smoothing.keyframes.walks import Motion
from estimator.smoothing.readings.rows import Linearised


class Solution(NamedTuple):
    """A solved window.

    Attributes:
        x: the estimate, flat: keyframes, then the border.
        chain: its normal equations at the estimate, not yet solved.
        linear: its rows at the estimate.
        weighted: how each row was weighed.
        motions: the walks' motion there.
        cost: negative log likelihood up to a constant.
        rests: the last step promised next to nothing.
    """

    x: Array
    chain: Chain
    linear: Linearised
    weighted: Weighted
    motions: list[Motion]
    cost: float
    rests: bool


class Trial(NamedTuple):
    """An estimate that a step may lead to: its rows' residuals, the walks' motion there, and its cost."""

    x: Array
    residual: Array
    motions: list[Motion]
    cost: float
