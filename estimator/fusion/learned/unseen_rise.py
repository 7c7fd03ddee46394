"""Whether an altimeter has jumped, or its bearer: in a lift, or through a floor, unseen by any unit."""

import math
from typing import NamedTuple

import msgspec

from estimator.fusion import physics

LEAST_M, USUAL_M = 2.2, 6.0
"""No two floors are nearer to each other, within what is read; lifts and falls go so far on average."""
PRESSURE_M = 1.6
"""What a fan at the door is taken to put on all inside: 20 Pa. Stairwells that are kept free of smoke are at
50 Pa (EN 12101-6), but who enters one walks."""
FANS = 3.0
"""So many steps of pressure are taken to come for one ride of a crew, or fall."""
BY_CHANCE = 0.2
"""How often a crew stands, all of them and together, when pressure steps."""
STANDING = 0.6
"""How often somebody stands when his altimeter steps, or soon after."""
WITNESSED, MOST = 0.2, 2
"""How often somebody else inside does not meet a step of pressure that others do; more say no more."""
WALKS_ON = 0.1
"""How often somebody who falls, or rides, walks before and after as if nothing had happened."""
GOES_ON_S = 8.0
"""A jump that begins so soon after another one, to the same side, is its rest: a lift takes its time."""
BACK = 0.3
"""A jump that leads back to within this share of one before it has undone that."""


class Rise(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """A jump of an altimeter, or of its bearer.

    Attributes:
        since_t: epoch of the first reading after it (s).
        until_t: epoch of the newest one by which it was found (s).
        up_m: by how much it is (m).
        was: name of the altimeter before it.
    """

    since_t: float = -math.inf
    until_t: float = -math.inf
    up_m: float = 0.0
    was: str = ""

    def goes_on(self, since_t: float, up_m: float) -> bool:
        """Whether one that begins at an epoch (s), by so much (m), is the same one, which goes on."""
        return 0.0 <= since_t - self.until_t < GOES_ON_S and self.up_m * up_m > 0.0

    def is_undone(self, up_m: float) -> bool:
        """Whether another one, by so much (m), leads back to before it."""
        return bool(self.was) and abs(self.up_m + up_m) < BACK * abs(self.up_m)


class Circumstances(NamedTuple):
    """What else is known where altimeters jump alike.

    Attributes:
        bearers: how many of them have.
        together: their bearers are at one place.
        standing: each of them stood meanwhile, or, who is alone, stands since.
        witnesses: how many others have not jumped.
    """

    bearers: int
    together: bool
    standing: bool
    witnesses: int


def risen_p(up_m: float, seen: Circumstances) -> float:
    """How likely it is bearers who have gone up or down, not what their altimeters are off by.

    A step of pressure is small, and met by all inside; one altimeter may be off by anything; who rides or
    falls goes a storey at least, and those who do so together are at one place and stand.

    Args:
        up_m: by how much their altimeters have jumped (m).
        seen: the circumstances.
    """
    size_m, alone = abs(up_m), seen.bearers == 1
    if size_m < LEAST_M or not (seen.together or alone):
        return 0.0
    risen = math.exp(-(size_m - LEAST_M) / USUAL_M) / USUAL_M
    pressed = FANS * _half_normal(size_m, PRESSURE_M) * WITNESSED ** min(seen.witnesses, MOST)
    if not alone:
        return risen / (risen + BY_CHANCE * pressed) if seen.standing else 0.0
    off = _half_normal(size_m, physics.HEIGHT_OFF_M) + pressed
    return risen / (risen + STANDING * off) if seen.standing else WALKS_ON * risen / (risen + off)


def _half_normal(size: float, sigma: float) -> float:
    return math.sqrt(2.0 / math.pi) / sigma * math.exp(-0.5 * (size / sigma) ** 2)
