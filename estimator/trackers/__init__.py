"""Trackers: the interface in `base`, and one file an estimator; here they are found by name."""

from estimator.trackers.base import Smoother, Tracker, TrackerSettings
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from estimator.trackers.paper_a import PaperATracker

TRACKERS: dict[str, type[KirchhoffTracker] | type[PaperATracker]] = {
    "kirchhoff": KirchhoffTracker,
    "paper-a": PaperATracker,
}
SMOOTHERS: dict[str, type[BatchSmoother]] = {"kirchhoff": BatchSmoother, "paper-a": BatchSmoother}
"""Paper A has no smoother of its own: what is known in the end does not depend on what was shown."""


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
        ValueError: another version wrote the snapshot, or it is none: fold the log anew.
    """
    return TRACKERS[name].restore(state)


def smoother(name: str, settings: TrackerSettings) -> Smoother:
    """The smoother that belongs to a tracker.

    Raises:
        KeyError: there is none of that name.
    """
    return SMOOTHERS[name](settings)
