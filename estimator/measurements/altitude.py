"""`altitude` and `pressure`: how high a node is."""

import math
from typing import Annotated

from msgspec import Meta

from estimator.measurements.base import Identifier, LengthM, Reading, SigmaM

PressurePa = Annotated[float, Meta(ge=10_000.0, le=200_000.0)]


class Altitude(Reading, tag="altitude", frozen=True):
    """Height above the incident's origin.

    Attributes:
        node: the node.
        up_m: height (m).
        sigma_m: standard deviation (m).
    """

    node: Identifier
    up_m: LengthM
    sigma_m: SigmaM | None = None


class Pressure(Reading, tag="pressure", frozen=True):
    """Air pressure at a node; the base's own readings are the reference.

    Attributes:
        node: the node.
        pressure_pa: air pressure (Pa).
        sigma_m: standard deviation of the height that follows from it (m).
    """

    node: Identifier
    pressure_pa: PressurePa
    sigma_m: SigmaM | None = None


GAS_CONSTANT = 287.05287
GRAVITY_MPS2 = 9.80665
STANDARD_K = 288.15


def height_above(reference_pa: float, pressure_pa: float) -> float:
    """Height of one barometer over another (m), by the hypsometric equation R T / g · ln(p_ref / p).

    Where the air between is 10 K warmer or colder than in the standard atmosphere, it is 3.5 % wrong.

    Args:
        reference_pa: air pressure at the reference (Pa).
        pressure_pa: air pressure at the node (Pa).
    """
    return GAS_CONSTANT * STANDARD_K / GRAVITY_MPS2 * math.log(reference_pa / pressure_pa)
