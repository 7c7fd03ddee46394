"""Which storey a node is on, from its height and how sure that is."""

from collections.abc import Sequence
from itertools import pairwise
from math import erf, sqrt
from typing import NamedTuple

STOREY_M = 3.0
"""Of a building whose storeys' floors are not told: from one to the next."""
NOWHERE = 1e-12
"""Probability of being between the lowest storey and the highest below which the height is not believed."""


class Level(NamedTuple):
    """The most probable storey.

    Attributes:
        level: integer storey, ground 0.
        name: how it is spoken of.
        probability: of this storey against all others.
    """

    level: int
    name: str
    probability: float


def most_probable(
    levels: Sequence[tuple[int, str, float]], up_m: float, up_variance_m2: float
) -> Level | None:
    """The storey on whose floor a node most probably stands: that of its height; None where none are known.

    A storey reaches from halfway down to the floor below it to halfway up to the floor above: what stands
    on a floor is at its height, and who is on a stair is counted to the nearer end. The lowest one and the
    highest reach as far to the other side: else whose height is hardly known would be on one of these two.

    Args:
        levels: integer storey, spoken name and height of its floor (m) of each, in any order.
        up_m: estimated height (m).
        up_variance_m2: its variance (m²).
    """
    storeys = sorted(levels, key=lambda item: item[2])
    if not storeys:
        return None
    floors = [up for _, _, up in storeys]
    heights = [above - below for below, above in pairwise(floors)] or [STOREY_M]
    edges = [floors[0] - heights[0] / 2.0]
    edges += [(below + above) / 2.0 for below, above in pairwise(floors)]
    edges.append(floors[-1] + heights[-1] / 2.0)
    sigma = max(sqrt(max(up_variance_m2, 0.0)), 1e-3)
    under = [_normal((edge - up_m) / sigma) for edge in edges]
    shares = [until - since for since, until in pairwise(under)]
    # Not the largest share: among storeys that differ in height it would change while nothing is heard.
    best = sum(edge < up_m for edge in edges[1:-1])
    level, name, _ = storeys[best]
    inside = sum(shares)
    return Level(level, name, min(max(shares[best] / inside, 0.0), 1.0) if inside > NOWHERE else 1.0)


def _normal(z: float) -> float:
    return 0.5 * (1.0 + erf(z / sqrt(2.0)))
