"""What the displacements of one unit tell of its gyro's bias: where its bearer stands, and walks straight."""

import math
from typing import NamedTuple

from estimator.fusion import physics
from estimator.fusion.learned.heading_line import Bias
from estimator.fusion.learned.zaru import stand_on
from estimator.fusion.memory.nodes import NodeState
from estimator.graph.robust import Mixture
from estimator.inertial.displacement import InertialDisplacement
from estimator.measurements.displacement import Displacement

SET_OFF_RAD2PS2 = physics.SET_OFF_BIAS_RADPS**2
"""What a bias is unsure by of which a standstill has told, once its bearer goes."""


class ToldBias(NamedTuple):
    """A gyro bias that a standstill or a straight leg has told.

    Attributes:
        t: epoch of the last report that tells it (s).
        bias: it.
        noise: how often it is another one.
        since: variance that it has gained since then (rad²/s²).
        leg_t: what straight legs have told after that epoch is of the same leg; this is beyond it (s).
    """

    t: float
    bias: Bias
    noise: Mixture
    since: float = 0.0
    leg_t: float = math.inf


class ToldBiases:
    """It takes one displacement after the other.

    Args:
        node: the unit.

    Attributes:
        still: headings that the unit has reported since it stands still.
        straight: what straight legs have told.
    """

    def __init__(self, node: NodeState) -> None:
        self.still, self.straight = node.still, node.straight
        self._told: list[ToldBias] = []

    def stand(self, reading: Displacement, still: bool) -> bool:
        """Go on standing, or stop.

        Args:
            reading: the displacement.
            still: it is none.

        Returns:
            Whether its bearer sets off after a bias has been told.
        """
        before, stood, told = self.still, None, None
        if still and reading.heading_rad is not None:
            stood, told = stand_on(before, reading.t, reading.heading_rad)
        elif still:
            stood = before
        elif before is not None:
            told = before.bias()
        self.still = stood
        sets_off = not still and before is not None and (before.told or told is not None)
        if type(reading) is InertialDisplacement and reading.rested_radps > 0.0:
            bias = Bias(0.0, reading.rested_radps)
            self._told.append(ToldBias(reading.t, bias, physics.TURN_NOISE))
        elif before is not None and told is not None:
            since = SET_OFF_RAD2PS2 if sets_off else 0.0
            self._told.append(ToldBias(before.line.t, told, physics.TURN_NOISE, since))
        return sets_off

    def walk(self, start_t: float, t: float, moved_m: tuple[float, float], walk_rad2: float) -> None:
        """Walk on: see `StraightLegs.walked`."""
        leg = self.straight.leg
        self.straight, told = self.straight.walked(start_t, t, moved_m, walk_rad2)
        if told is not None:
            bias = Bias(told.value, self.straight.sigma_radps(told.sigma))
            leg_t = math.inf if leg is None or leg.line is None else leg.line.since_t
            self._told.append(ToldBias(t, bias, physics.STRAIGHT_NOISE, leg_t=leg_t))

    def take(self) -> tuple[ToldBias, ...]:
        """What has been told since this was last asked."""
        told, self._told = tuple(self._told), []
        return told
