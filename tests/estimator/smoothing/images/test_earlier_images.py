"""Somebody of whom two radios did not tell the side, long after he came to the line between them."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.estimate import NodeEstimate
from estimator.fusion.images import Alternative, Image
from estimator.fusion.memory.nodes import Mode
from estimator.measurements import AnyReading
from estimator.measurements.range import Range
from estimator.smoothing import window_extent
from estimator.smoothing.images.earlier_images import still_likely
from estimator.trackers.base import TrackerSettings
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.smoothing.images.test_flip_ambiguity import TWO, crossing, solved_of

THIRD_M = (32.0, 10.0)
LEFT_S, WAITS_S, TOLD_S = 60, 190, 200


def followed(side: float) -> dict[int, NodeEstimate]:
    """He lingers on the line, leaves it to one side, and waits; at last he hears a third radio."""
    chance = np.random.default_rng(5)
    radios = TWO | {"a3": THIRD_M}
    tracker = KirchhoffTracker(TrackerSettings())
    tracker.fold([r for r in crossing(radios) if not isinstance(r, Range)])
    found = {}
    for second in range(1, TOLD_S + 1):
        north_m = -20.0 + second if second < 20 else side * np.clip(second - LEFT_S, 0.0, 30.0)
        heard: list[AnyReading] = [
            Range(
                t=float(second),
                a="ff1",
                b=name,
                range_m=off_m + float(chance.normal(0.0, 0.1)),
                technology="uwb",
            )
            for name, (e, n) in radios.items()
            if (off_m := float(np.hypot(12.0 - e, north_m - n))) and (name in TWO or second > WAITS_S)
        ]
        tracker.fold(heard)
        found[second] = next(e for e in tracker.estimates() if e.node == "ff1")
    return found


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_side_that_nobody_could_tell_for_minutes_stays_open_until_a_third_radio_tells(
    side: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(window_extent, "LONGEST_S", 60.0)
    found = followed(side)
    for second in (100, 150, WAITS_S):
        here = found[second]
        assert here.position_m is not None
        assert here.covariance_m2 is not None
        assert abs(here.position_m[1]) == pytest.approx(30.0, abs=1.5)
        assert np.sqrt(here.covariance_m2[3]) > 15.0
    last = found[TOLD_S]
    assert last.position_m is not None
    assert last.covariance_m2 is not None
    assert last.position_m[1] == pytest.approx(side * 30.0, abs=1.5)
    assert np.sqrt(last.covariance_m2[3]) < 2.0


@pytest.mark.parametrize(("mode", "open_"), [("free", 1), ("retired", 0)])
def test_nobody_asks_any_more_for_the_side_of_who_has_retired(mode: Mode, open_: int) -> None:
    problem, solved = solved_of(crossing(TWO))
    nodes, same = problem.layout.state.nodes, Image()
    before = Alternative(nodes["ff1"].index, 0.4, same, problem.layout.grid[0] - 1.0, same)
    nodes["ff1"] = replace(nodes["ff1"], mode=mode, otherwise=(before,))
    assert len(still_likely(problem, solved)[2]) == open_
