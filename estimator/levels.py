"""Which storey a node is on, from its height and how sure that is."""

from collections.abc import Sequence
from itertools import pairwise
from math import erf, inf, sqrt
from typing import NamedTuple


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
    levels: Sequence[tuple[int, str, float]], up_m: float, up_variance_m2: float, body_m: float = 0.0
) -> Level | None:
    """The storey whose floor a node most probably stands on; None where no storeys are known.

    A storey reaches from halfway down to the floor below it to halfway up to the floor above: what stands
    on a floor is at its height, and who is on a stair is counted to the nearer end.

    Args:
        levels: integer storey, spoken name and height of its floor (m) of each, in any order.
        up_m: estimated height (m).
        up_variance_m2: its variance (m²).
        body_m: how high over its floor the node is carried (m).
    """
    storeys = sorted(levels, key=lambda item: item[2])
    if not storeys:
        return None
    floors = [up for _, _, up in storeys]
    edges = [-inf, *((a + b) / 2.0 for a, b in pairwise(floors)), inf]
    sigma = max(sqrt(max(up_variance_m2, 0.0)), 1e-3)
    below = [_normal((edge + body_m - up_m) / sigma) for edge in edges]
    shares = [after - before for before, after in pairwise(below)]
    best = max(range(len(storeys)), key=shares.__getitem__)
    level, name, _ = storeys[best]
    return Level(level, name, min(max(shares[best], 0.0), 1.0))


def _normal(z: float) -> float:
    return 0.5 * (1.0 + erf(z / sqrt(2.0)))
