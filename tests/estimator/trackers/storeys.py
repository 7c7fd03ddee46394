"""On which storey somebody is shown, and how sure that is."""

from collections.abc import Sequence
from typing import NamedTuple

from estimator.estimate import Covariance6, Vector3
from estimator.levels import most_probable

STOREY_M, LOWEST, HIGHEST, ON_A_FLOOR_M = 3.5, -2, 12, 0.4
LEVELS = [(k, str(k), STOREY_M * k) for k in range(LOWEST, HIGHEST)]
Judged = tuple[bool, bool] | None


class Storeys(NamedTuple):
    """Seconds on a floor, those sure (p > 0.9) of its storey, and those sure of another one."""

    seconds: int
    right: int
    wrong: int


def judged(height_m: float, position_m: Vector3 | None, covariance_m2: Covariance6 | None) -> Judged:
    """Whether the storey that is shown of somebody is right, and whether it is sure; None: he is on none."""
    assert position_m is not None
    assert covariance_m2 is not None
    floor = round(height_m / STOREY_M)
    if abs(height_m - floor * STOREY_M) > ON_A_FLOOR_M:
        return None
    storey = most_probable(LEVELS, position_m[2], covariance_m2[5])
    assert storey is not None
    return storey.level == floor, storey.probability > 0.9


def counted(shown: Sequence[Judged]) -> Storeys:
    found = [one for one in shown if one is not None]
    right = sum(fits and sure for fits, sure in found)
    return Storeys(len(found), right, sum(sure and not fits for fits, sure in found))
