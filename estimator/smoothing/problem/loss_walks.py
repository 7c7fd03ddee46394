"""What is known beforehand of losses: in sight nothing is lost, else much; and mostly as much as before."""

import math
from collections.abc import Collection, Mapping
from copy import copy
from typing import Self

import numpy as np

from estimator.fusion.memory.prior import Key
from estimator.graph.dense import Array, Indices
from estimator.graph.robust import Mixture, Weighted, mixture_cost, weigh
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.losses import STEP_S, Loss
from estimator.smoothing.problem.usual_losses import USUAL_LOSSES

SIGNS = np.array([1.0, -1.0, -1.0, 1.0])
"""Of what a loss is more than what is lost to all radios, the change since the one before."""
HELD = 1e-3, 0.0, 0.0, 1.0
"""What is held is as good as known."""


class LossWalks:
    """Losses of crews, step by step, as readings of nil.

    They tell what is lost to all radios, what is lost to one beside that, and how both change.

    Args:
        layout: of the window.
        known: the blocks that the window's prior tells of already.
        held: kinds of readings of which nothing is lost but what the prior tells.

    Attributes:
        columns: of the border, m × 4: a loss, what is lost to all radios then, and both before it; −1: none.
        jacobian: derivatives of what is read, m × 4.
        noise: standard deviation, outliers, shift and spread of each, 4 × m.
        gains: which of them tell only that nothing is gained, m.
        size: how many numbers come before the border.
    """

    def __init__(self, layout: Layout, known: Collection[Key], held: Collection[int] = ()) -> None:
        lost = layout.lost
        told = [one for key, one in lost.items() if key not in known]
        gained = [(one, usual) for one in told if (usual := USUAL_LOSSES[one.kind].gained) is not None]
        ends = [_columns(lost, one) for one in told] + [(one.column, -1, -1, -1) for one, _ in gained]
        self.columns: Indices = np.array(ends, dtype=np.intp).reshape(-1, 4)
        self.jacobian: Array = np.where(self.columns >= 0, SIGNS, 0.0)
        rows = [
            HELD if one.kind in held else _noise(one, None if one.before is None else lost[one.before])
            for one in told
        ]
        rows += [(usual, 0.0, 0.0, 1.0) for _, usual in gained]
        self.gains = np.arange(len(ends)) >= len(told)
        self.noise: Array = np.array(rows, dtype=np.float64).reshape(-1, 4).T.copy()
        self.size = layout.length * layout.width

    def part(self, layout: Layout) -> Self:
        """The same of a part of the window, which has all of its border."""
        other = copy(self)
        other.size = layout.length * layout.width
        return other

    def cost(self, x: Array) -> float:
        """Negative log likelihood at an estimate, flat, up to a constant."""
        if not self.columns.size:
            return 0.0
        residual = self.residual(x)
        costs = mixture_cost(residual, *self.noise)
        gained = np.where(residual < 0.0, costs - np.log(self.noise[0]), 0.0)
        return float(np.where(self.gains, gained, costs).sum())

    def weighed(self, x: Array) -> Weighted:
        """How they pull at an estimate, flat."""
        (sigma, *noise), residual = self.noise, self.residual(x)
        found = weigh(residual, sigma, np.zeros_like(sigma), *noise)
        found.information[self.gains & (residual >= 0.0)] = 0.0
        return found

    def residual(self, x: Array) -> Array:
        """What is read, nil, less what is lost at an estimate, flat, m (dB, or m)."""
        return np.asarray(-(self.jacobian * x[self.size + self.columns]).sum(axis=1))


def _columns(lost: Mapping[Key, Loss], loss: Loss) -> tuple[int, int, int, int]:
    """A loss, what is lost to all radios then, and both of them before."""
    before = None if loss.before is None else lost[loss.before]
    ends = loss, _common(lost, loss), before, None if before is None else _common(lost, before)
    first, second, third, fourth = (-1 if one is None else one.column for one in ends)
    return first, second, third, fourth


def _common(lost: Mapping[Key, Loss], loss: Loss) -> Loss | None:
    return None if loss.common is None else lost[loss.common]


def _noise(loss: Loss, before: Loss | None) -> tuple[float, float, float, float]:
    """Standard deviation of a loss, or of how it has changed, and its outliers."""
    common, beside, _ = USUAL_LOSSES[loss.kind]
    usual = common if loss.common is None else beside
    if before is None:
        return (usual.sigma, *usual.behind)
    changes, steps = usual.changes, (loss.since_s - before.since_s) / STEP_S
    ever = Mixture(1.0 - (1.0 - changes.outliers) ** steps, changes.shift, changes.spread)
    return (usual.walk * math.sqrt(steps), *ever)
