"""Who is timed: the tracker, and GTSAM's iSAM2 on the same readings.

Of iSAM2 only `update`, `calculateEstimate` of the responders' newest poses and, told apart from these,
`marginalCovariance` of them are timed; making factors in Python is not. RSSI reaches it as a range by a fixed
law: a factor in dB would be a Python function that it calls back, and that would be no measure of it.
"""

from collections.abc import Sequence
from typing import Protocol

from backend.bench.accuracy.gtsam_factors import load
from backend.bench.accuracy.gtsam_nodes import Walker
from backend.bench.accuracy.gtsam_peer import Incremental
from backend.bench.speed.figures import Spent
from backend.bench.speed.laps import Laps
from backend.bench.speed.stopwatch import Stopwatch
from backend.interpreter import tune_for_serving
from estimator.estimate import TrackPoint
from estimator.measurements import AnyReading
from estimator.trackers.kirchhoff import KirchhoffTracker
from estimator.warm import warm_up

Tracks = dict[str, list[TrackPoint]]
WARM_S = 12
"""Two solutions of the tracker's window: its compiled functions are then loaded."""

SKIPS = (10, 1)
"""`relinearizeSkip` of iSAM2: its default, and what its accuracy needs."""


class Contestant(Protocol):
    """Takes a second's readings and says what that took; keeps its tracks to be judged."""

    name: str
    tracks: Tracks

    def take(self, readings: Sequence[AnyReading]) -> Spent:
        """Take the readings of one second in, and estimate where the responders are.

        Raises:
            RuntimeError: the system has no single solution.
        """


class Ours:
    """The tracker as it is used: fold, then all estimates, which come with their covariances."""

    def __init__(self) -> None:
        self.name = "firethread"
        self.tracks: Tracks = {}
        self._tracker = KirchhoffTracker()

    def take(self, readings: Sequence[AnyReading]) -> Spent:
        """Fold a second's readings."""
        watch = Stopwatch()
        with watch:
            self._tracker.fold(readings)
            found = self._tracker.estimates()
        for e in found:
            if e.position_m is not None and e.covariance_m2 is not None and e.role == "responder":
                track = self.tracks.setdefault(e.node, [])
                if not track or track[-1].t != e.t:
                    track.append(TrackPoint(t=e.t, position_m=e.position_m, covariance_m2=e.covariance_m2))
        return Spent(watch.spent_s, watch.spent_s)


class Isam(Incremental):
    """iSAM2 with default parameters, but for how often it relinearises.

    Args:
        skip: it relinearises at each update of so many; by default of 10.
    """

    def __init__(self, skip: int) -> None:
        super().__init__(in_db=False)
        self.name = f"iSAM2, skip {skip}"
        self.tracks: Tracks = {}
        parameters = self.factors.gtsam.ISAM2Params()
        parameters.relinearizeSkip = skip
        self.isam = self.factors.gtsam.ISAM2(parameters)

    def take(self, readings: Sequence[AnyReading]) -> Spent:
        """Make a second's factors, and time the solution."""
        for reading in readings:
            self.graph.take(reading)
        estimating, marginalising = Stopwatch(), Stopwatch()
        while True:
            self.graph.retry()
            factors, values = self.graph.take_new()
            if factors.size() == 0:
                break
            with estimating:
                self.isam.update(factors, values)
            for _, walker in self._begun():
                key = walker.key
                with estimating:
                    pose = self.isam.calculateEstimatePose2(key)
                walker.pose = (pose.x(), pose.y(), pose.theta())
        for name, walker in self._begun():
            key = walker.key
            with marginalising:
                self.isam.marginalCovariance(key)
            track = self.tracks.setdefault(name, [])
            if not track or track[-1].t != walker.t_s[-1]:
                shown = self.shown(walker)
                track += [] if shown is None else [shown]
        return Spent(estimating.spent_s, estimating.spent_s + marginalising.spent_s)

    def _begun(self) -> list[tuple[str, Walker]]:
        return [(name, walker) for name, walker in self.graph.walkers.items() if walker.begun]


def rivals() -> list[Contestant]:
    """The tracker, and iSAM2 with each `relinearizeSkip`.

    Raises:
        GtsamMissing: GTSAM is not installed.
    """
    load()
    return [Ours(), *(Isam(skip) for skip in SKIPS)]


def warm() -> None:
    """Let the tracker work for a moment: what it loads at first is no part of any keyframe.

    Not all of its compiled functions are needed in the first seconds: they are loaded beforehand, as `make`
    compiles them.

    Then the collector is set as the worker sets it: whoever makes the next object in Python would have to
    look through all that numba and GTSAM have loaded.
    """
    warm_up()
    laps, tracker = Laps(responders=2, breadcrumbs=9), Ours()
    tracker.take(laps.introductions())
    for second in range(1, WARM_S + 1):
        tracker.take(laps.second(second))
    tune_for_serving()
