"""How far a boot is on its way from the foothold that was told last."""

from typing import NamedTuple

from estimator.inertial.displacement import InertialDisplacement, displacement_of
from estimator.inertial.footholds import gone_s, landed_share
from estimator.inertial.progress import JITTER_S, Navigation


class UnderWay(NamedTuple):
    """A boot at its newest sample.

    Attributes:
        led: how far it is from where its way was cut last.
        share: how much of the time from there to its next foothold has passed, if it stands there; nil where
            it is still to come down.
        gone_s: for how long its bearer has gone on since, if he does as before (s).
    """

    led: InertialDisplacement
    share: float
    gone_s: float


def under_way(known: Navigation, node: str) -> UnderWay | None:
    """Where a boot is that has not been told yet; None: it has been, or nobody knows.

    Args:
        known: where its samples have led to.
        node: whose it is.
    """
    if not known.boot.levelled or known.missing or known.t <= known.told_t + JITTER_S:
        return None
    led = displacement_of(known.boot, node, known.told_t, known.t, known.unsure_m2)
    return UnderWay(led, landed_share(known.boot.footholds), gone_s(known.boot.footholds))
