"""A unit that is worn the wrong way round: what it reports is mirrored, or turned by some angle.

Whose box is upside down on his boot goes to the left where he goes to the right, and its gyro turns the other
way; whose box is turned on it, or faced elsewhere at first than was told, goes where he does not look.
"""

import math
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from estimator.fusion.entering.introduce import turn_sigma
from estimator.fusion.images import Image
from estimator.fusion.learned.straight_legs import StraightLegs
from estimator.fusion.memory.ledger import GYRO_BIAS
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.inertial.levelling import ANYWHERE_RAD
from estimator.measurements.bearing import within_pi
from estimator.measurements.displacement import Displacement


class Mounting(NamedTuple):
    """How a unit is worn, as what corrects its reports: mirrored, if at all, then turned to the left.

    Attributes:
        mirrored: left and right of its reports are exchanged.
        turned_rad: by how much they are then turned.
    """

    mirrored: bool = False
    turned_rad: float = 0.0

    @property
    def image(self) -> Image:
        """The correction as an image of the ground plane."""
        return Image(math.cos(self.turned_rad), math.sin(self.turned_rad), -1.0 if self.mirrored else 1.0)

    def of(self, east: float, north: float) -> tuple[float, float]:
        """A reported displacement, corrected: east, north (m)."""
        led_e, led_n = self.image.of(np.array((east, north))).tolist()
        return led_e, led_n

    def faced(self, heading_rad: float | None) -> float | None:
        """A reported heading, corrected (rad)."""
        if heading_rad is None:
            return None
        return within_pi((-heading_rad if self.mirrored else heading_rad) + self.turned_rad)

    def after(self, first: "Mounting") -> "Mounting":
        """Both corrections as one: first `first`, then this."""
        turned = -first.turned_rad if self.mirrored else first.turned_rad
        return Mounting(self.mirrored != first.mirrored, within_pi(turned + self.turned_rad))

    def back(self) -> "Mounting":
        """The inverse."""
        return self if self.mirrored else Mounting(False, -self.turned_rad)


RIGHT = Mounting()
"""The right way round."""


def mounting_of(node: NodeState) -> Mounting:
    """How a node's unit is taken to be worn."""
    return Mounting(*node.worn)


def reported(node: NodeState, reading: Displacement) -> Displacement:
    """A displacement, corrected by how its unit is taken to be worn."""
    if node.worn == RIGHT:
        return reading
    worn = mounting_of(node)
    east, north, up = reading.delta_m
    return replace(reading, delta_m=(*worn.of(east, north), up), heading_rad=worn.faced(reading.heading_rad))


def mount(state: FusionState, number: int, worn: Mounting) -> None:
    """Take a unit to be worn so from its beginning, in all that it has reported.

    What was told of where a turned one faced at first says nothing: it may have been told wrongly as well.

    Args:
        state: the fusion, changed in place: the ledger, not the Kirchhoff state.
        number: of the node.
        worn: how.
    """
    node = state.life(number)
    change = worn.after(mounting_of(node).back())
    begins = state.ledger.table("begins").copy()
    begun = (begins[:, 1] == number) & (begins[:, 2] == 1.0)
    begins[begun, 11] = turn_sigma(node) if worn.turned_rad == 0.0 else ANYWHERE_RAD
    state.ledger.replace("begins", begins)
    steps = state.ledger.table("steps").copy()
    mine = steps[:, 1] == number
    steps[mine, 3:5] = change.image.of(steps[mine, 3:5])
    state.ledger.replace("steps", steps)
    if change.mirrored:
        singles = state.ledger.table("singles").copy()
        turns = (singles[:, 1] == number) & (singles[:, 2] == GYRO_BIAS)
        singles[turns, 3] *= -1.0
        state.ledger.replace("singles", singles)
    trail = tuple((t, *change.of(east, north), up) for t, east, north, up in node.trail)
    state.keep(
        replace(
            node,
            worn=tuple(worn),
            trail=trail,
            faced=change.of(*node.faced),
            still=None,
            straight=StraightLegs(),
            unit_heading_rad=change.faced(node.unit_heading_rad),
            first_heading_rad=change.faced(node.first_heading_rad),
        )
    )
