"""The blocks of technologies in the Kirchhoff matrix: scale and bias of ranges, path loss, bodies."""

from functools import lru_cache

from estimator.fusion import physics
from estimator.fusion.learned import reach
from estimator.fusion.learned.calibration import bias_sigma_m
from estimator.fusion.memory.ledger import UNTOLD_POWER
from estimator.fusion.memory.state import FusionState
from estimator.graph.variable import Variable

Numbers = tuple[float, float, float]
SENT = "sent"
"""Owner of the path-loss states of radios that tell the power they send with; "" for those that do not."""
TOLD_POWER = UNTOLD_POWER + SENT
"""Technology of signals that do; the owner of their path-loss states stands last."""
REACH = UNTOLD_POWER + "reach"
"""How far radios reach, as a law of powers of which a crossing is the reading 0 dBm."""


def technology_states(state: FusionState, technology: str) -> Variable:
    """The block of scale, bias and bodies of a ranging technology, added when first used."""
    states = technology_variable(technology)
    if states not in state.graph:
        state.graph.add_node(states, (0.0, 0.0, 0.0), ranging_sigma(state, technology))
    return states


def ranging_sigma(state: FusionState, technology: str) -> Numbers:
    """Standard deviations of scale, bias and bodies of a ranging technology beforehand."""
    bodies = state.body_sigma(technology, powers=False)
    return state.range_scale_sigma(technology), bias_sigma_m(technology), bodies


def path_loss_states(state: FusionState, technology: str) -> Variable:
    """The block of P0, n and bodies of radios that tell the power they send with, or of the others."""
    states = path_loss_variable(technology)
    if states not in state.graph:
        state.graph.add_node(states, *path_loss_prior(state, technology))
    return states


@lru_cache(maxsize=256)
def technology_variable(technology: str) -> Variable:
    """The key of the block of a technology, of ranges or of powers: each tick asks for it several times."""
    powers = technology.startswith(UNTOLD_POWER)
    return path_loss_variable(technology) if powers else Variable("range", technology)


@lru_cache(maxsize=256)
def path_loss_variable(technology: str) -> Variable:
    """The key of the block of a technology of signals: the same."""
    return Variable("rssi", technology[len(UNTOLD_POWER) :])


def path_loss_prior(state: FusionState, technology: str) -> tuple[Numbers, Numbers]:
    """P0, n and bodies beforehand, and their standard deviations."""
    bodies = state.body_sigma(technology, powers=True)
    if technology == REACH:
        means = reach.REACH_DB, reach.EXPONENT, 0.0
        return means, (reach.REACH_SIGMA_DB, reach.EXPONENT_SIGMA, bodies)
    means = physics.RSSI_POWER_DBM, physics.RSSI_EXPONENT, 0.0
    return means, (physics.RSSI_POWER_SIGMA_DB, physics.RSSI_EXPONENT_SIGMA, bodies)
