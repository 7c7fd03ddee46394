"""Standing still tells the gyro bias: ZARU (decision 0020).

The true heading stays, so what the unit turns meanwhile is −β Δt. Reported headings are noisy, and their
noise is not told: β is the slope of a line through those of a standstill, and what they scatter about it says
how good it is. The longer the line, the better: cut into pieces of 5 s, half a minute tells a fifth.
"""

import msgspec

from estimator.fusion import physics
from estimator.fusion.learned.heading_line import Bias, HeadingLine


class Standing(msgspec.Struct, frozen=True, array_like=True):
    """Headings that a unit has reported since it stands still, as far as they are not used yet.

    Attributes:
        line: the headings.
        told: this standstill has told a bias before.
    """

    line: HeadingLine
    told: bool = False

    def bias(self) -> Bias | None:
        """The bias that they show; None where they are too few."""
        line = self.line
        if line.number < physics.STILL_READINGS or line.lasted_s < physics.STILL_S:
            return None
        return line.bias(physics.STILL_JITTER_RAD, physics.GYRO_WALK_RAD_PER_ROOT_S**2)


def stand_on(before: Standing | None, t: float, heading_rad: float) -> tuple[Standing, Bias | None]:
    """A unit that still stands reports its heading.

    Args:
        before: what it has reported since it stands; None: it just came to a stand.
        t: epoch (s).
        heading_rad: the heading.

    Returns:
        What is not used yet, and the bias where it is told now: the standstill was long, or ended by a turn
        or by a silence, in which the bearer may have turned.
    """
    anew = HeadingLine(t, t, heading_rad)
    if before is None:
        return Standing(anew), None
    since_s = t - before.line.t
    turned_most = physics.STILL_TURN_RADPS * max(since_s, 1.0)
    if since_s > physics.STILL_SILENT_S or abs(before.line.step_rad(heading_rad)) > turned_most:
        bias = before.bias()
        return Standing(anew, told=before.told or bias is not None), bias
    standing = Standing(before.line.extended(t, heading_rad), before.told)
    if standing.line.lasted_s < physics.STILL_LONG_S or standing.line.number < physics.STILL_READINGS:
        return standing, None
    return Standing(anew, told=True), standing.bias()
