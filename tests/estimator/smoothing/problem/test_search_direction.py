"""Directions that go on along what was gone before."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from estimator.graph.dense import Array
from estimator.smoothing.problem.search_direction import Direction, NewtonStep, conjugate_step

NUMBERS = 8


def hill(seed: int, stiffness: Array) -> tuple[Array, Array]:
    """Normal equations, and curvature that differs from them by these factors, NUMBERS × NUMBERS each."""
    chance = np.random.default_rng(seed)
    turned, across = (np.linalg.qr(chance.normal(0.0, 1.0, (NUMBERS, NUMBERS)))[0] for _ in range(2))
    root = turned * chance.uniform(0.5, 4.0, NUMBERS)
    return root @ root.T, root @ across @ np.diag(1.0 / stiffness) @ across.T @ root.T


def newton_at(x: Array, matrix: Array, curvature: Array) -> NewtonStep:
    """The step to the optimum, which is 0, by normal equations that are not the curvature."""
    slope = np.asarray(-curvature @ x, dtype=np.float64)
    step = np.asarray(np.linalg.solve(matrix, slope), dtype=np.float64)
    return NewtonStep(step, slope, 0.5 * float(slope @ step))


def left(x: Array, directions: int, matrix: Array, curvature: Array, conjugate: bool) -> float:
    """What is still to be gained after some directions, each followed to where most is gained."""
    before: tuple[NewtonStep, Array] | None = None
    for _ in range(directions):
        newton = newton_at(x, matrix, curvature)
        gone = (
            conjugate_step(newton, *before)
            if before and conjugate
            else Direction(newton.step, newton.promised)
        )
        x = x + float(newton.slope @ gone.step) / float(gone.step @ curvature @ gone.step) * gone.step
        before = newton, gone.step
    return 0.5 * float(x @ curvature @ x)


@given(st.integers(0, 2**32 - 1))
def test_as_many_directions_as_the_curvature_is_off_by_factors_lead_to_the_optimum(seed: int) -> None:
    stiffness = np.array([1.0, 1.0, 2.0, 2.0, 2.0, 5.0, 5.0, 1.0])
    matrix, curvature = hill(seed, stiffness)
    x = np.random.default_rng(seed + 1).normal(0.0, 1.0, NUMBERS)
    before = 0.5 * float(x @ curvature @ x)
    assert left(x, 3, matrix, curvature, conjugate=True) < 1e-12 * before


def test_where_one_mode_is_ten_times_too_stiff_far_less_is_left_than_by_newtons_steps() -> None:
    matrix, curvature = hill(3, np.geomspace(1.0, 10.0, NUMBERS))
    x = np.random.default_rng(4).normal(0.0, 1.0, NUMBERS)
    conjugate, plain = (left(x, 6, matrix, curvature, way) for way in (True, False))
    assert conjugate < 0.1 * plain


@given(st.integers(0, 2**32 - 1))
def test_every_direction_leads_uphill_and_promises_what_its_slope_does(seed: int) -> None:
    chance = np.random.default_rng(seed)
    matrix, curvature = hill(seed, chance.uniform(0.5, 5.0, NUMBERS))
    newton = newton_at(chance.normal(0.0, 1.0, NUMBERS), matrix, curvature)
    before = newton_at(chance.normal(0.0, 1.0, NUMBERS), matrix, curvature)
    found = conjugate_step(newton, before, chance.normal(0.0, 1.0, NUMBERS))
    assert found.promised > 0.0
    assert np.isclose(found.promised, 0.5 * newton.slope @ found.step)


def test_where_the_slope_has_not_turned_the_step_is_newtons() -> None:
    matrix, curvature = hill(1, np.ones(NUMBERS))
    before = newton_at(np.ones(NUMBERS), matrix, curvature)
    newton = newton_at(0.5 * np.ones(NUMBERS), matrix, curvature)
    assert conjugate_step(newton, before, before.step).step is newton.step
