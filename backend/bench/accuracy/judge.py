"""Tracks against truth: the errors of all responders of a case together."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from estimator.estimate import TrackPoint
from estimator.evaluate import Errors, errors, full_covariance
from estimator.simulate import TrueTrack
from estimator.simulate.base import FloatArray

FLAT_M = 0.1
"""Truth that stays within this height is a plane's: it does not judge heights."""


class Drawn(NamedTuple):
    """One responder's track beside the truth, for plots.

    Attributes:
        node: the responder.
        t_s: epochs, n (s).
        estimated_m: east and north, n × 2 (m).
        true_m: the same of the truth.
        path_m: the whole true path, k × 2 (m).
    """

    node: str
    t_s: FloatArray
    estimated_m: FloatArray
    true_m: FloatArray
    path_m: FloatArray

    @property
    def off_m(self) -> FloatArray:
        """Horizontal errors, n (m)."""
        off = self.estimated_m - self.true_m
        return np.hypot(off[:, 0], off[:, 1])


class Verdict(NamedTuple):
    """What is said of an entrant on one case.

    Attributes:
        errors: of all responders pooled; `ve95_m` is NaN where heights are not judged.
        shown: share of the responders' seconds for which there is an estimate.
        drawn: the tracks.
    """

    errors: Errors
    shown: float
    drawn: tuple[Drawn, ...]


def judge(
    tracks: Mapping[str, Sequence[TrackPoint]], truth: Mapping[str, TrueTrack], heights: bool
) -> Verdict:
    """Compare tracks with the truth at the tracks' own epochs; epochs without truth are not judged.

    Percentages are of the responders' mean way; the aligned RMSE takes one rigid motion for all of them.

    Args:
        tracks: estimates of each node; of nodes without truth nothing is said.
        truth: true tracks of the responders.
        heights: the entrant estimates heights.

    Raises:
        ValueError: no responder has an estimate.
    """
    estimated, true, covariances, drawn = [], [], [], []
    expected = 0.0
    for node, track in truth.items():
        first_s, last_s = float(track.t_s[0]), float(track.t_s[-1])
        expected += last_s - first_s
        points = [p for p in tracks.get(node, ()) if first_s <= p.t <= last_s]
        t_s = np.array([p.t for p in points])
        positions = np.array([p.position_m for p in points]).reshape(-1, 3)
        estimated.append(positions)
        true.append(track.at(t_s))
        covariances += [p.covariance_m2 for p in points]
        drawn.append(Drawn(node, t_s, positions[:, :2], true[-1][:, :2], track.position_m[:, :2]))
    seconds = sum(len(np.unique(np.floor(one.t_s))) for one in drawn)
    if not covariances:
        raise ValueError("no responder has an estimate")
    way_m = float(np.mean([track.distance_m for track in truth.values()]))
    found = errors(
        np.concatenate(estimated), np.concatenate(true), full_covariance(np.array(covariances)), way_m
    )
    flat = all(float(np.ptp(track.position_m[:, 2])) < FLAT_M for track in truth.values())
    if flat or not heights:
        found = found._replace(ve95_m=float("nan"))
    return Verdict(found, min(1.0, seconds / max(expected, 1.0)), tuple(drawn))
