"""When a window is solved again."""

import math

import pytest

from estimator.fusion.memory.state import FusionState
from estimator.measurements.node import Node
from estimator.smoothing.window_solution import refresh
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.trackers.entry import BASE, step


def test_what_a_unit_faces_is_asked_ever_more_rarely_the_longer_it_has_led_him(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Nothing tells it: each second at first, and for ever, it would cost a whole crew's time."""
    solved = list[float]()

    def noted(state: FusionState, solved_t: float, bent: bool = False) -> bool:
        solved.append(state.newest_t)
        return refresh(state, solved_t, bent)

    monkeypatch.setattr("estimator.smoothing.window.refresh", noted)
    tracker = KirchhoffTracker()
    tracker.fold(
        [BASE, Node(t=0.0, node="ff1", role="responder", position_m=(0, 0, 0), heading_sigma_rad=math.pi)]
    )
    for second in range(1, 61):
        tracker.fold([step(float(second))])
        tracker.estimates()
    early, late = (len({t for t in solved if a <= t < a + 6.0}) for a in (1.0, 54.0))
    assert early >= 5
    assert late <= 2
