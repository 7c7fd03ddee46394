"""Maps that distances alone hold are told with what else they may be."""

from functools import lru_cache

import numpy as np
import pytest

from estimator.fusion.images import EVER
from estimator.measurements.displacement import Displacement
from estimator.smoothing.images.unknown_north import turned_maps
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from tests.estimator.smoothing.images.test_flip_ambiguity import solved_of
from tests.estimator.trackers.test_unknown_north import SPEED_MPS, introduced, readings_of, way

SECONDS = 40


@lru_cache
def walked(anchor_s: float, with_unit: bool = False) -> tuple[Problem, Solution]:
    """The window of two who have walked, with another told place from then on (s)."""
    places_m, chance = way(), np.random.default_rng(7)
    readings = introduced(places_m)
    for second in range(SECONDS):
        readings += readings_of(second, places_m, chance, anchor_s)
        if with_unit:
            gone_m = (SPEED_MPS, 0.0, 0.0)
            readings.append(Displacement(t=second + 1.0, node="f0", from_t=float(second), delta_m=gone_m))
    return solved_of(sorted(readings, key=lambda reading: reading.t))


def test_about_one_told_place_a_map_may_be_turned_anyhow() -> None:
    problem, solved = walked(np.inf)
    shown, modes = turned_maps(problem, solved)
    assert shown is solved
    turned_rad = [np.arctan2(mode.way.sine, mode.way.cosine) for mode in modes]
    assert np.degrees(turned_rad) % 360.0 == pytest.approx([90.0, 180.0, 270.0])
    assert {mode.since_t for mode in modes} == {EVER}
    # Where each of both began was told to a metre, and tells a little.
    assert min(mode.share for mode in modes) > 0.05
    assert sum(mode.share for mode in modes) < 1.0
    for mode in modes:
        from_base_m = [np.hypot(*problem.layout.states(x, 0)[-1, :2]) for x in (solved.x, mode.x)]
        assert from_base_m[0] == pytest.approx(from_base_m[1], abs=0.3)


def test_between_two_told_places_it_may_be_mirrored_and_no_more() -> None:
    problem, solved = walked(5.0)
    _, modes = turned_maps(problem, solved)
    assert [mode.way.flip for mode in modes] == [-1.0]


def test_a_unit_that_leads_anybody_tells_north() -> None:
    problem, solved = walked(np.inf, with_unit=True)
    assert turned_maps(problem, solved) == (solved, [])
