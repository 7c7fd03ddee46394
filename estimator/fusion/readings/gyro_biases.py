"""Gyro biases that units tell, standing still or walking straight, as readings that are kept."""

import math
from collections.abc import Iterable

import numpy as np

from estimator.fusion import physics
from estimator.fusion.learned.straight_legs import StraightLegs
from estimator.fusion.memory.ledger import GYRO_BIAS
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.told_biases import ToldBias
from estimator.fusion.rows.rows import Single


def enter(state: FusionState, node: NodeState, told: Iterable[ToldBias]) -> list[Single]:
    """Keep the biases that a unit has told, and give them as they are held against the graph.

    The tick moves on first, then takes in what was told before.
    """
    singles = []
    for t, bias, noise, since in told:
        kind = float(physics.NOISES.index(noise))
        state.ledger.add("singles", t, node.index, GYRO_BIAS, *bias, kind, -1.0)
        singles.append(Single(node.unit, 1, bias.value, math.sqrt(bias.sigma**2 + since), noise))
    return singles


def weigh_anew(state: FusionState, node: NodeState, before: StraightLegs, after: StraightLegs) -> None:
    """Weigh what a bearer's earlier straight legs told, once he has gone another one (decision 0120).

    Args:
        state: the fusion.
        node: the bearer.
        before: his legs before that one.
        after: with it.
    """
    singles = state.ledger.table("singles")
    own = (singles[:, 1] == node.index) & (singles[:, 5] == physics.NOISES.index(physics.STRAIGHT_NOISE))
    if own.any():
        singles = singles.copy()
        alone = (singles[own, 4] ** 2 - before.shared_rad2ps2) / before.bent
        singles[own, 4] = np.sqrt(alone * after.bent + after.shared_rad2ps2)
        state.ledger.replace("singles", singles)
