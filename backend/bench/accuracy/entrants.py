"""Who competes. An entrant gets readings in order of posting, and nothing else."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Literal, NamedTuple

from backend.bench.accuracy import gtsam_peer, least_squares
from estimator import trackers
from estimator.estimate import TrackPoint
from estimator.inertial.navigation import navigate
from estimator.inertial.progress import Navigation
from estimator.inertial.samples import pieces
from estimator.measurements import Imu
from estimator.simulate import Report
from estimator.trackers.base import Tracker, TrackerSettings

Tracks = dict[str, list[TrackPoint]]
Mode = Literal["online", "smoothed"]


class Entrant(NamedTuple):
    """One competitor.

    Attributes:
        name: as `--trackers` takes it.
        mode: online: each point from what was posted until it was shown; smoothed: from everything.
        heights: it estimates heights.
        takes: whether the readings are of the kind that it is made for.
        track: gives the tracks of the nodes that it follows, by node.
    """

    name: str
    mode: Mode
    heights: bool
    takes: Callable[[Sequence[Report]], bool]
    track: Callable[[Sequence[Report]], Tracks]


def entrants() -> list[Entrant]:
    """All of them, online and smoothed side by side."""
    found: list[Entrant] = []
    for name in trackers.TRACKERS:
        found.append(Entrant(name, "online", True, _anything, partial(_online, name)))
        if name in trackers.SMOOTHERS:
            found.append(Entrant(name, "smoothed", True, _anything, partial(_smoothed, name)))
    found += [Entrant(name, "smoothed", True, _anything, partial(_smoothed, name)) for name in _only_smooth()]
    found.append(Entrant("gtsam", "online", False, _anything, partial(_displaced, gtsam_peer.online)))
    found.append(Entrant("gtsam", "smoothed", False, _anything, partial(_displaced, gtsam_peer.smoothed)))
    found.append(Entrant("least-squares", "online", False, least_squares.takes, least_squares.track))
    return found


def seconds(reports: Sequence[Report]) -> Iterator[list[Report]]:
    """What is posted in each second in which anything is, in order of posting."""
    waiting: list[Report] = []
    shown_s = -math.inf
    for report in reports:
        if report.sent_s > shown_s:
            if waiting:
                yield waiting
            waiting, shown_s = [], math.ceil(report.sent_s)
        waiting.append(report)
    if waiting:
        yield waiting


def _only_smooth() -> list[str]:
    return [name for name in trackers.SMOOTHERS if name not in trackers.TRACKERS]


def _anything(reports: Sequence[Report]) -> bool:
    return bool(reports)


def _online(name: str, reports: Sequence[Report]) -> Tracks:
    """The estimates as they stand at each whole second, each at the epoch that it says it is for."""
    tracker: Tracker = trackers.create(name, TrackerSettings())
    tracks: Tracks = {}
    for posted in seconds(reports):
        tracker.fold([report.reading for report in posted])
        for e in tracker.estimates():
            if e.position_m is None or e.covariance_m2 is None or e.retired:
                continue
            track = tracks.setdefault(e.node, [])
            # Without news of a node the same estimate stays on the screen; it counts once.
            if not track or track[-1].t != e.t:
                track.append(TrackPoint(t=e.t, position_m=e.position_m, covariance_m2=e.covariance_m2))
    return tracks


def _displaced(track: Callable[[Sequence[Report]], Tracks], reports: Sequence[Report]) -> Tracks:
    """Tracks of an entrant that takes no raw samples: it gets the displacements that ours make of them."""
    navigations: dict[str, Navigation] = {}
    told: list[Report] = []
    for report in reports:
        if not isinstance(report.reading, Imu):
            told.append(report)
            continue
        for piece in pieces(report.reading):
            done = navigate(navigations.get(piece.node), piece, 0.0)
            navigations[piece.node] = done.navigation
            told += [replace(report, reading=displacement) for displacement in done.displacements]
    return track(told)


def _smoothed(name: str, reports: Sequence[Report]) -> Tracks:
    return trackers.smoother(name, TrackerSettings()).smooth([report.reading for report in reports])
