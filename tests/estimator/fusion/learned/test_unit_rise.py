"""A unit's heights rise by themselves, or the ground does: what legs tell of either (0128)."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimator.fusion.learned import unit_rise
from estimator.fusion.learned.level_legs import legs_of
from estimator.fusion.learned.unit_rise import RISES, RISES_GRID, SHARES, SLOPES_GRID, rises_of
from estimator.graph.dense import Array

PACE_M, SIGMA_M, ON_THE_LEVEL_M = 0.7, 0.03, 0.6
LEVEL = len(SLOPES_GRID) // 2


def walked(rises: float, ground: Array, seed: int, turns: bool = True) -> Array:
    """What a unit tells that rises, of somebody who walks to and fro, or on, on such slopes."""
    n = len(ground)
    towards = np.where(np.arange(n) // 28 % 2 == 0, 1.0, -1.0) if turns else np.ones(n)
    up_m = PACE_M * (rises + ground) + SIGMA_M * np.random.default_rng(seed).normal(size=n)
    nothing = np.zeros(n)
    return np.column_stack([PACE_M * towards, nothing, up_m, nothing + SIGMA_M**2, nothing + 1.0])


def climbed_m(moved: Array) -> float:
    """What is left of what a unit tells."""
    gone_m = np.hypot(moved[:, 0], moved[:, 1])
    return float((moved[:, 2] - rises_of(moved, 0.0, RISES**2).of_rows * gone_m).sum())


def test_slopes_are_whole_steps_of_rises() -> None:
    """So that a leg's rise is looked up by the sum of both."""
    sums = unit_rise.SUMS[np.arange(len(RISES_GRID))[:, None] + unit_rise.OF_SLOPES]
    np.testing.assert_allclose(sums, RISES_GRID[:, None] + SLOPES_GRID, atol=1e-12)


@settings(max_examples=30)
@given(st.floats(-0.06, 0.06), st.integers(0, 1000))
def test_what_a_unit_rises_by_on_the_level_is_found(rises: float, seed: int) -> None:
    moved = walked(rises, np.zeros(300), seed)
    told = rises_of(moved, 0.0, RISES**2)
    assert told.mean == pytest.approx(rises, abs=0.02)
    assert abs(climbed_m(moved)) < ON_THE_LEVEL_M + 3.0 * told.doubt_m


@pytest.mark.parametrize("rises", [-0.02, 0.0, 0.02])
def test_what_a_stair_climbs_stays(rises: float) -> None:
    moved = walked(rises, np.concatenate([np.zeros(100), np.full(12, 0.5), np.zeros(100)]), 1)
    assert climbed_m(moved) == pytest.approx(0.5 * 12 * PACE_M, abs=ON_THE_LEVEL_M)


@pytest.mark.parametrize("slope", [0.02, 0.04, 0.07, 0.12])
@pytest.mark.parametrize("level_first", [0, 60])
def test_of_a_slope_that_lasts_as_much_is_told_as_is_known(slope: float, level_first: int) -> None:
    """A hill, or a ramp round and round: who has walked on the level before knows more of it."""
    ground = np.concatenate([np.zeros(level_first), np.full(200, slope), np.zeros(100)])
    for seed in range(4):
        moved = walked(0.0, ground, seed, turns=False)
        doubt_m = rises_of(moved, 0.0, RISES**2).doubt_m
        assert abs(climbed_m(moved) - ground.sum() * PACE_M) < ON_THE_LEVEL_M + 3.0 * doubt_m


def test_what_was_known_before_is_taken_up() -> None:
    """A window forgets: the first half's legs are told to the second half as a mean and its variance."""
    moved = walked(0.03, np.zeros(300), 2)
    first = rises_of(moved[:150], 0.0, RISES**2)
    onward, whole = rises_of(moved[150:], first.mean, first.variance), rises_of(moved, 0.0, RISES**2)
    assert onward.mean == pytest.approx(whole.mean, abs=2e-3)
    assert rises_of(moved[:3], 0.03, 1e-4).mean == 0.03


def passage(turns: bool) -> Array:
    """How one leg's rise and slope lead to the next one's, as one matrix, by the words of the constants."""
    slopes, k = np.zeros((len(SLOPES_GRID), len(SLOPES_GRID))), len(SLOPES_GRID)
    for since in range(k):
        slopes[:, since] += unit_rise.SETS_OUT_P * SHARES
        if since == LEVEL:
            slopes[LEVEL, since] += 1.0 - unit_rise.SETS_OUT_P
        elif turns:
            slopes[since, since] += unit_rise.STAYS_P
            slopes[k - 1 - since, since] += unit_rise.RETURNS_P
            left = 1.0 - unit_rise.SETS_OUT_P - unit_rise.STAYS_P - unit_rise.RETURNS_P
            slopes[LEVEL, since] += left
        else:
            slopes[since, since] += 1.0 - unit_rise.SETS_OUT_P - unit_rise.LEVELS_P
            slopes[LEVEL, since] += unit_rise.LEVELS_P
    n, anything = len(RISES_GRID), np.exp(-0.5 * (RISES_GRID / RISES) ** 2)
    rises = (1.0 - 2.0 * unit_rise.CHANGED_P - unit_rise.REPLACED_P) * np.eye(n)
    for r in range(n):
        for to in (max(r - 1, 0), min(r + 1, n - 1)):
            rises[to, r] += unit_rise.CHANGED_P
    rises += unit_rise.REPLACED_P * np.outer(anything / anything.sum(), np.ones(n))
    return np.asarray(np.kron(rises, slopes), dtype=np.float64)


@pytest.mark.parametrize("turns", [False, True])
def test_every_passage_leads_somewhere(turns: bool) -> None:
    np.testing.assert_allclose(passage(turns).sum(axis=0), 1.0)


def test_it_is_what_a_hidden_markov_model_of_whole_matrices_tells() -> None:
    """The same by its textbook form: products of matrices, and moments of the climb leg by leg in pairs."""
    moved = walked(0.01, np.concatenate([np.zeros(16), np.full(20, 0.06), np.zeros(16)]), 3)
    legs, told = legs_of(moved), rises_of(moved, 0.0, RISES**2)
    rise, slope = (both.ravel() for both in np.meshgrid(RISES_GRID, SLOPES_GRID, indexing="ij"))
    known = np.exp(-0.5 * (RISES_GRID / RISES) ** 2)
    inclined = unit_rise.INCLINED_P * SHARES
    inclined[LEVEL] = 1.0 - unit_rise.INCLINED_P
    begins = np.kron(known / known.sum(), inclined)
    fits = [np.exp(-0.5 * (z - rise - slope) ** 2 / v) for z, v in zip(legs.rise, legs.variance, strict=True)]
    steps = [passage(bool(turns)) for turns in legs.turns]

    def expected(*of: tuple[int, Array]) -> float:
        """Mean of a product of functions of the legs' states."""
        weight, plain = begins, begins
        for i, fit in enumerate(fits):
            weight, plain = (weight, plain) if i == 0 else (steps[i] @ weight, steps[i] @ plain)
            weight, plain = weight * fit, plain * fit
            for leg, function in of:
                weight = weight * function if leg == i else weight
        return float(weight.sum() / plain.sum())

    n = len(fits)
    assert n > 2
    climbs = [slope * way_m for way_m in legs.way_m]
    mean_m = sum(expected((i, climbs[i])) for i in range(n))
    square_m2 = sum(expected((i, climbs[i]), (j, climbs[j])) for i in range(n) for j in range(n))
    assert told.doubt_m == pytest.approx((square_m2 - mean_m**2) ** 0.5, rel=1e-6)
    assert told.mean == pytest.approx(expected((n - 1, rise)), rel=1e-6)
    for i in range(n):
        of_leg = told.of_rows[legs.of_row == i]
        np.testing.assert_allclose(of_leg, legs.rise[i] - expected((i, slope)), rtol=1e-6)
