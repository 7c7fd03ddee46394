"""What the tracker keeps to roll back to: what late readings need, however long the incident lasts."""

from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.trackers.kirchhoff import KirchhoffTracker

STEPS = 400


def walk(steps: int) -> list[AnyReading]:
    first = Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.1)
    steps_of = [
        Displacement(t=float(k), from_t=k - 1.0, node="ff1", delta_m=(1.0, 0.0, 0.0))
        for k in range(1, steps + 1)
    ]
    return [first, *steps_of]


def test_a_late_reading_goes_back_to_a_state_soon_before_it() -> None:
    tracker = KirchhoffTracker()
    for reading in walk(STEPS):
        tracker.fold([reading])
        tracker.estimates()
    ticks = [tick for tick, _ in tracker._lag._checkpoints]
    for late_s in (1, 3, 10, 30, 55):
        before = max(tick for tick in ticks if tick <= STEPS - late_s)
        assert STEPS - late_s - before <= 16


def test_what_is_kept_does_not_grow_with_the_incident() -> None:
    sizes = []
    for steps in (800, 1600):
        tracker = KirchhoffTracker()
        for reading in walk(steps):
            tracker.fold([reading])
            tracker.estimates()
        sizes.append(len(tracker.snapshot()))
        assert len(tracker._lag._checkpoints) < 20
    assert sizes[1] < 1.1 * sizes[0]
