"""Legs of a way without a stair."""

import numpy as np
import pytest

from estimator.fusion.learned.level_legs import LEG_M, UNEVEN, legs_of
from estimator.graph.dense import Array

PACE_M, SIGMA_M = 0.7, 0.03


def displacements(east_m: Array, up_m: Array, told: Array | float = 1.0) -> Array:
    nothing = np.zeros(len(east_m))
    return np.column_stack([east_m, nothing, up_m, np.full(len(east_m), SIGMA_M**2), nothing + told])


def test_a_leg_tells_what_it_rises_for_each_metre() -> None:
    legs = legs_of(displacements(np.full(100, PACE_M), np.full(100, 0.02 * PACE_M)))
    assert len(legs.rise) == int(99 * PACE_M / (LEG_M + 0.5))
    np.testing.assert_allclose(legs.rise, 0.02)
    np.testing.assert_allclose(legs.variance, SIGMA_M**2 / PACE_M / legs.way_m + UNEVEN**2)
    assert not legs.turns.any()


def test_a_stair_is_part_of_no_leg_nor_are_the_strides_beside_it() -> None:
    """They may be half on it."""
    up_m = np.zeros(60)
    up_m[30:42], up_m[29], up_m[42] = 0.3, 0.08, 0.08
    legs = legs_of(displacements(np.full(60, PACE_M), up_m))
    assert not legs.rise.any()
    assert (legs.of_row[30:42] < 0).all()


def test_a_stair_that_is_climbed_slowly_is_no_leg() -> None:
    """Twenty in a hundred: stride by stride that may be noise."""
    legs = legs_of(displacements(np.full(60, 0.5), np.full(60, 0.1)))
    assert len(legs.rise) == 0
    assert (legs.of_row == -1).all()


def test_reports_of_a_tenth_of_a_second_make_the_same_legs() -> None:
    """A stride is looked at, not a report: a boot rises and falls within it."""
    slow = displacements(np.full(60, PACE_M), np.full(60, 0.01 * PACE_M))
    fast = np.repeat(slow, 10, axis=0) * np.array([0.1, 0.1, 0.1, 0.1, 1.0])
    swing_m = np.tile([0.03, 0.03, 0.02, 0.0, 0.0, 0.0, 0.0, -0.02, -0.03, -0.03], 60)
    fast[:, 2] += swing_m
    np.testing.assert_allclose(legs_of(fast).rise.mean(), legs_of(slow).rise.mean(), atol=2e-3)


def test_who_turns_round_does_so_on_a_leg() -> None:
    to_and_fro = np.where(np.arange(120) // 24 % 2 == 0, PACE_M, -PACE_M)
    legs = legs_of(displacements(to_and_fro, np.zeros(120)))
    assert 4 <= np.count_nonzero(legs.turns) < len(legs.turns)


@pytest.mark.parametrize("told", [0.0, 1.0])
def test_a_time_of_which_a_unit_has_told_nothing_is_no_leg(told: float) -> None:
    silent = displacements(np.full(60, PACE_M), np.zeros(60), told)
    assert bool(len(legs_of(silent).rise)) == bool(told)


def test_who_stands_has_no_legs() -> None:
    assert len(legs_of(displacements(np.zeros(50), np.zeros(50))).rise) == 0
    assert len(legs_of(np.zeros((0, 5))).rise) == 0
