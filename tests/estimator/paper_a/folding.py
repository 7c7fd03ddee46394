"""Paper A's tracker with readings in it, and what it says of a node."""

import numpy as np

from estimator.estimate import NodeEstimate
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.trackers.paper_a import PaperATracker


def folded(*batches: list[AnyReading]) -> PaperATracker:
    tracker = PaperATracker()
    for batch in batches:
        tracker.fold(batch)
    return tracker


def estimate(tracker: PaperATracker, node: str) -> NodeEstimate:
    return next(e for e in tracker.estimates() if e.node == node)


def place(tracker: PaperATracker, node: str) -> Array:
    return np.array(estimate(tracker, node).position_m)
