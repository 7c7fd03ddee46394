"""Ways of some seconds that fit what a radio ranges: as its unit has gone, or as nobody tells.

Each way is a few numbers; how well it fits is its evidence by Laplace's approximation, so that a way that can
bend anywhere pays for it (MacKay, Bayesian interpolation, Neural Computation 4, 1992).
"""

from collections.abc import Callable
from typing import NamedTuple, Self

import numpy as np

from estimator.fusion import physics
from estimator.graph.dense import Array
from estimator.smoothing.changes.track_fit import RangedTrack, TrackFit, fit_track

WENT_S = 1.0
"""Where a bearer faces is where he went in so long."""
KNOT_S = 2.5
"""Between so many seconds a radio that nobody leads goes straight."""
SPEED_MPS = 1.2
ANYWHERE_M = 20.0
"""How far from where it is thought to be a radio is looked for."""
OWN_M, OWN_SHARE = 0.1, 0.04
"""What a unit's own way is off by: a stride, and a share of what it has gone."""
KNOWN: Array = np.diag([ANYWHERE_M**-2.0, ANYWHERE_M**-2.0, np.pi**-2.0])

Led = Callable[[Array], Array]


class RangedUnit(NamedTuple):
    """Ranges of a radio to what stands, and how its unit has gone.

    Attributes:
        t: epochs, m (s).
        ranged: the ranges.
        led: displacement of its unit up to any epochs: east, north, m × 2 (m).
    """

    t: Array
    ranged: RangedTrack
    led: Led

    def stretched(self, scale: float) -> Self:
        """The same, of a unit whose displacements are so many times as long."""
        return self._replace(led=lambda t: scale * self.led(t))

    def worn(self, ahead_m: float) -> Self:
        """The same, of a radio that is so far ahead of its unit: so bodies make it seem (m)."""

        def led(t: Array) -> Array:
            went = self.led(t) - self.led(t - WENT_S)
            way_m = np.hypot(*went.T)[:, None]
            faced = np.where(way_m > physics.GOES_MPS * WENT_S, went / np.maximum(way_m, 1e-9), 0.0)
            return self.led(t) + ahead_m * faced

        return self._replace(led=led)


def fit_along_unit(heard: RangedUnit, at_m: Array, turns_rad: Array, late_s: float = 0.0) -> TrackFit:
    """The likeliest way that is the unit's own, wherever it begins and whatever the unit faces.

    Args:
        heard: the ranges.
        at_m: about where it is in the middle: east, north (m).
        turns_rad: ψ to begin from.
        late_s: by how much the ranges are stamped late (s).

    Returns:
        The way, whose last number is ψ.
    """
    own_m = heard.led(heard.t - late_s)
    own_m = own_m - own_m.mean(axis=0)
    unsure_m2 = OWN_M**2 + (OWN_SHARE * np.hypot(*own_m.T)) ** 2
    ranged = heard.ranged._replace(sigma_m=np.sqrt(heard.ranged.sigma_m**2 + unsure_m2))
    starts = [np.array([*at_m, turn]) for turn in turns_rad.tolist()]
    found = [fit_track(ranged, own_m, True, start, KNOWN) for start in starts]
    return max(found, key=lambda fit: fit.evidence)


def fit_freely(heard: RangedUnit, begins: list[Array]) -> TrackFit:
    """The likeliest way that goes straight from knot to knot.

    Args:
        heard: the ranges.
        begins: ways to begin from: east, north, m × 2 each (m).
    """
    since, until = heard.t.min(), heard.t.max()
    count = max(int(np.ceil((until - since) / KNOT_S)), 1) + 1
    at = (heard.t - since) / max(until - since, 1e-9) * (count - 1)
    left = np.minimum(at.astype(np.intp), count - 2)
    row, share = np.arange(len(at)), np.zeros((len(at), count))
    share[row, left], share[row, left + 1] = 1.0 - (at - left), at - left
    step = np.diff(np.eye(count), axis=0) / (SPEED_MPS * KNOT_S)
    whole = step.T @ step + np.full((count, count), (ANYWHERE_M * count) ** -2.0)
    known: Array = np.kron(whole, np.eye(2))
    to_knots = np.asarray(np.linalg.pinv(share), dtype=np.float64)
    starts = [(to_knots @ one).ravel() for one in begins]
    found = [fit_track(heard.ranged, share, False, start, known) for start in starts]
    return max(found, key=lambda fit: fit.evidence)
