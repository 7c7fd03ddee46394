"""Trackers: the interface in `base`, and one file an estimator; here they are found by name."""

from estimator.trackers.base import Smoother, Tracker, TrackerSettings
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker

TRACKERS: dict[str, type[KirchhoffTracker]] = {"kirchhoff": KirchhoffTracker}
SMOOTHERS: dict[str, type[BatchSmoother]] = {"kirchhoff": BatchSmoother}


def create(name: str, settings: TrackerSettings) -> Tracker:
    """A new tracker.

    Raises:
        KeyError: there is none of that name.
    """
    return TRACKERS[name](settings)


def restore(name: str, state: bytes) -> Tracker:
    """The tracker that goes on where a snapshot was taken.

    Raises:
        KeyError: there is none of that name.
        ValueError: another version wrote the snapshot.
    """
    return TRACKERS[name].restore(state)


def smoother(name: str, settings: TrackerSettings) -> Smoother:
    """The smoother that belongs to a tracker.

    Raises:
        KeyError: there is none of that name.
    """
    return SMOOTHERS[name](settings)
