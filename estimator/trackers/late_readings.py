"""What is said of readings that came too late."""

from collections.abc import Sequence

from estimator.trackers.lag_record import Leap


def too_late(count: int, lag_s: float, leaps: Sequence[Leap], t: float) -> str:
    """What is said of a node: a notice takes the place of the one before, so that it counts all so far.

    Args:
        count: how many of its readings have come too late.
        lag_s: how late they may be (s).
        leaps: the newest leaps of the newest epoch.
        t: epoch of the newest of them (s).
    """
    came = "1 reading so far came" if count == 1 else f"{count} readings so far came"
    many = "is" if count == 1 else "are"
    return f"{came} more than {lag_s:g} s late and {many} not fused{_why(lag_s, leaps, t)}"


def _why(lag_s: float, leaps: Sequence[Leap], t: float) -> str:
    """Whose reading made an epoch (s) too late, where one alone did."""
    for leap in leaps:
        since_t = float("-inf") if leap.from_t is None else leap.from_t - lag_s
        if since_t <= t < leap.to_t - lag_s:
            by = "" if leap.from_t is None else f" by {leap.to_t - leap.from_t:.0f} s"
            return f": a reading of {leap.node} put time forward{by} to t = {leap.to_t:.0f}"
    return ""
