"""Gyro biases that units tell, standing still or walking straight, as readings that are kept."""

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from estimator.fusion import physics
from estimator.fusion.learned.straight_legs import StraightLegs
from estimator.fusion.memory.ledger import GYRO_BIAS
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.told_biases import ToldBias
from estimator.fusion.rows.rows import Single
from estimator.graph.dense import Array
from estimator.measurements.bearing import within_pi

DOUBTED = 2.5
"""So many sigmas off what was told of it and a gyro makes, a frame speaks against what was told."""


def enter(state: FusionState, node: NodeState, biases: Iterable[ToldBias]) -> list[Single]:
    """Keep the biases that a unit has told, and give them as they are held against the graph.

    The tick moves on first, then takes in what was told before. What straight legs tell of a unit whose frame
    is in question waits for the window's next solution: a wrong frame has made what the graph knows of ψ and
    β together, and the truth of β would turn ψ further off.
    """
    singles = []
    for told in biases:
        _keep(state, node, told)
        if told.noise is not physics.STRAIGHT_NOISE or not is_in_question(state, node):
            sigma = math.sqrt(told.bias.sigma**2 + told.since)
            singles.append(Single(node.unit, 1, told.bias.value, sigma, told.noise))
    return singles


def _keep(state: FusionState, node: NodeState, told: ToldBias) -> None:
    """Keep a bias, together with what the same leg has told before: a window holds a leg as a whole."""
    t, (value, sigma), noise, _, leg_t = told
    if leg_t < t:
        singles = state.ledger.table("singles")
        earlier = _of_legs(singles, node) & (singles[:, 0] > leg_t)
        if earlier.any():
            known, product = sigma**-2, value * sigma**-2
            for before, before_sigma in singles[earlier, 3:5].tolist():
                known += before_sigma**-2
                product += before * before_sigma**-2
            value, sigma = product / known, known**-0.5
            state.ledger.replace("singles", singles[~earlier])
    kind = float(physics.NOISES.index(noise))
    state.ledger.add("singles", t, node.index, GYRO_BIAS, value, sigma, kind, -1.0)


def _of_legs(singles: Array, node: NodeState) -> NDArray[np.bool_]:
    """Which single readings a unit's straight legs have told, of rows of the ledger."""
    kind = physics.NOISES.index(physics.STRAIGHT_NOISE)
    return np.asarray((singles[:, 1] == node.index) & (singles[:, 5] == kind))


def is_in_question(state: FusionState, node: NodeState) -> bool:
    """Whether a unit's frame may be turned by any angle, or is by more than what was told and gyros explain.

    Args:
        state: the fusion.
        node: the unit.
    """
    begins = state.ledger.table("begins")
    mine = begins[(begins[:, 1] == node.index) & (begins[:, 2] == 1.0)]
    if node.turned or not len(mine):
        return node.turned
    begun_t, told_rad, sigma_rad = mine[-1][[0, 10, 11]].tolist()
    gyro_rad = state.bias_sigma_radps(node) * (node.pose_t - begun_t)
    turned_rad = within_pi(float(state.graph.value(node.unit)[0]) - told_rad)
    return abs(turned_rad) > DOUBTED * math.hypot(sigma_rad, gyro_rad)


def weigh_anew(state: FusionState, node: NodeState, before: StraightLegs, after: StraightLegs) -> None:
    """Weigh what a bearer's straight legs have told, once they tell more (decision 0120).

    Args:
        state: the fusion.
        node: the bearer.
        before: his legs before that.
        after: with it.
    """
    singles = state.ledger.table("singles")
    own = _of_legs(singles, node)
    if own.any():
        singles = singles.copy()
        singles[own, 4] *= math.sqrt(after.unsurer / before.unsurer)
        state.ledger.replace("singles", singles)
