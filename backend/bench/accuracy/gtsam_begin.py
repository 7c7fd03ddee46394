"""Where a node of the GTSAM peer begins whose place nobody told: a least-squares guess over its first ranges.

It is delayed until the guess is decided: starts all round must agree on one place, clearly the best.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from backend.bench.accuracy.gtsam_factors import Offset
from backend.bench.accuracy.gtsam_nodes import Pose
from estimator.simulate.base import FloatArray

FEWEST = 8
GUESS_EVERY = 10
CLEARLY = 1.5
"""A second place must cost so many times as much, …"""
APART_M = 2.0
"""… if it is farther away than this."""

STARTS = 12
HEADINGS = 8
SHORTEST_WAY_M = 1.0


class Seen(NamedTuple):
    """One range between a known and an unknown node.

    Attributes:
        known: east and north of the known end (m).
        offset: of the unknown end from where it was at first, in its own frame (m).
        range_m: measured (m).
        sigma_m: its standard deviation (m).
    """

    known: tuple[float, float]
    offset: Offset
    range_m: float
    sigma_m: float


class Tries:
    """When a guess is tried again: whenever enough more ranges have come."""

    def __init__(self) -> None:
        self._at: dict[str, int] = {}

    def is_worth_one(self, name: str, count: int) -> bool:
        """Whether a node with so many ranges is worth a try now."""
        if count < self._at.get(name, 0) + GUESS_EVERY:
            return False
        self._at[name] = count
        return True


def guess(seen: Sequence[Seen], turned: bool) -> Pose | None:
    """Where the unknown node was at first; None while that is not decided.

    Args:
        seen: its ranges.
        turned: its frame may be turned by any angle, which is then found as well; else it is not turned.
    """
    if len(seen) < FEWEST:
        return None
    known = np.array([s.known for s in seen])
    offset = np.array([s.offset for s in seen])
    range_m = np.array([s.range_m for s in seen])
    sigma = np.array([s.sigma_m for s in seen])

    def residual(x: FloatArray) -> FloatArray:
        angle = x[2] if turned else 0.0
        cosine, sine = math.cos(angle), math.sin(angle)
        east = x[0] + cosine * offset[:, 0] - sine * offset[:, 1] - known[:, 0]
        north = x[1] + sine * offset[:, 0] + cosine * offset[:, 1] - known[:, 1]
        off: FloatArray = (np.hypot(east, north) - range_m) / sigma
        return off

    found = []
    for start in _starts(known, float(np.median(range_m)), turned):
        solved = least_squares(residual, start, loss="cauchy", f_scale=2.0, max_nfev=60)
        found.append((float(solved.cost), solved.x))
    found.sort(key=lambda one: one[0])
    cost, best = found[0]
    others = [c for c, x in found if math.hypot(x[0] - best[0], x[1] - best[1]) > APART_M]
    if others and others[0] < CLEARLY * max(cost, 0.5 * len(seen)):
        return None
    return float(best[0]), float(best[1]), float(best[2]) if turned else 0.0


def _starts(known: FloatArray, range_m: float, turned: bool) -> list[FloatArray]:
    """Starts on a ring around the middle of the known places, with headings all round if asked."""
    middle = known.mean(axis=0)
    ring = [2.0 * math.pi * k / STARTS for k in range(STARTS)]
    places = [(middle[0] + range_m * math.cos(a), middle[1] + range_m * math.sin(a)) for a in ring]
    if not turned:
        return [np.array(place) for place in places]
    headings = [2.0 * math.pi * k / HEADINGS - math.pi for k in range(HEADINGS)]
    near = [(float(middle[0]), float(middle[1])), *places[::4]]
    return [np.array([*place, heading]) for place in near for heading in headings]
