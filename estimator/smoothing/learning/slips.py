"""Steps of a unit that are known to have been reported wrongly, and what becomes of them in the ledger."""

from typing import NamedTuple

import numpy as np

from estimator.fusion import physics
from estimator.fusion.memory.ledger import CLAIMED
from estimator.fusion.memory.state import FusionState


class Slip(NamedTuple):
    """A step that was reported wrongly.

    Attributes:
        number: of the unit's node in the ledger.
        t: middle of the step's time (s).
        off_m: what is missing of it, or too much: east, north (m).
    """

    number: int
    t: float
    off_m: tuple[float, float]


def withdraw(state: FusionState) -> None:
    """Take back all slips: whoever knows more is to judge them again.

    Args:
        state: its ledger loses the steps without displacement or time that stand for them.
    """
    steps = state.ledger.table("steps")
    slipped = (steps[:, 0] == steps[:, 2]) & (steps[:, 6] == physics.SLIP_M**2)
    state.ledger.replace("steps", steps[~slipped])


def widen_steps(state: FusionState, slips: list[Slip]) -> None:
    """Let the ledger's steps be as uncertain as slips are, where they have been found.

    Args:
        state: its ledger takes a step without displacement for each.
        slips: of a solved window; whoever solves it again finds them no more.
    """
    for slip in slips:
        up2, given = physics.DISPLACEMENT_FLOOR_M**2, CLAIMED
        state.ledger.add(
            "steps", slip.t, slip.number, slip.t, *(0.0,) * 3, physics.SLIP_M**2, up2, 0.0, 0.0, 0.0, given
        )
        name = state.owners[slip.number]
        text = f"{name} reported a step wrongly, by {np.hypot(*slip.off_m):.1f} m: it stumbled or slid"
        state.say("outlier", slip.t, name, text)
        state.count("outlier")
