"""A turn of the whole map, about the place about which it is known least."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.graph.dense import Array
from estimator.graph.gauge import (
    UNIT_M,
    Turning,
    change_pairs,
    held,
    pivot,
    turn_about,
    turn_pairs,
    turned_along,
    turning,
)

seeds = st.integers(0, 10_000)
PLACES, SPEEDS, HEADINGS = np.array([[0, 1], [2, 3]]), np.array([[4, 5]]), np.array([6])
CHANGED, NUMBERS = Turning(PLACES, SPEEDS, HEADINGS), 7
"""Two places, a velocity and a heading."""
BASE_M = np.zeros(2)


def turned_about(here: Array, pivot_m: Array, by_rad: float) -> Array:
    """All numbers with the map turned."""
    there = here.copy()
    there[PLACES] = pivot_m + (here[PLACES] - pivot_m) @ turning(by_rad)
    there[SPEEDS] = here[SPEEDS] @ turning(by_rad)
    there[HEADINGS] += by_rad
    return there


@given(seeds, st.floats(-7.0, 7.0))
def test_places_are_turned_about_the_pivot_and_velocities_about_nil(seed: int, by_rad: float) -> None:
    chance = np.random.default_rng(seed)
    here, pivot_m = chance.normal(0.0, 30.0, NUMBERS), chance.normal(0.0, 30.0, 2)
    there = turned_about(here, pivot_m, by_rad)
    turn_pairs(here, PLACES, pivot_m, by_rad)
    turn_pairs(here, SPEEDS, BASE_M, by_rad)
    here[HEADINGS] += by_rad
    assert here == pytest.approx(there, abs=1e-9)


@given(seeds)
def test_a_turn_changes_all_that_it_takes_along(seed: int) -> None:
    """Finite differences of the map turned as a whole."""
    chance = np.random.default_rng(seed)
    here, pivot_m = chance.normal(0.0, 30.0, NUMBERS), chance.normal(0.0, 30.0, 2)
    forth, back = (turned_about(here, pivot_m, by_rad) for by_rad in (1e-4, -1e-4))
    assert turn_about(here, CHANGED, pivot_m) == pytest.approx((forth - back) / 2e-4, abs=1e-4)


@given(seeds)
def test_what_is_held_of_changes_is_so_in_matrices_with_spare_rows(seed: int) -> None:
    chance = np.random.default_rng(seed)
    half, ways = chance.normal(0.0, 1.0, (9, 9)), chance.normal(0.0, 1.0, (2, NUMBERS))
    matrix = half @ half.T
    assert held(matrix, ways) == pytest.approx(ways @ matrix[:NUMBERS, :NUMBERS])


@given(seeds)
def test_what_knew_no_turn_of_where_places_were_knows_none_of_where_they_are(seed: int) -> None:
    chance = np.random.default_rng(seed)
    was = chance.normal(0.0, 30.0, NUMBERS)
    now = was + 0.1 * np.abs(was).min() * chance.uniform(-1.0, 1.0, NUMBERS)
    old, new = turn_about(was, CHANGED, BASE_M), turn_about(now, CHANGED, BASE_M)
    rows = chance.normal(0.0, 1.0, (12, NUMBERS))
    rows -= np.outer(rows @ old, old) / (old @ old)
    matrix, vector = rows.T @ rows, rows.T @ np.ones(12)
    stiff = float(np.abs(matrix).max() * (new @ new))
    for pairs in (PLACES, SPEEDS):
        change_pairs(matrix, vector, pairs, turned_along(was, now, pairs, BASE_M))
    # Of a place at r m from the base, 1 m² / r² of the way that it has moved is left as it was.
    near = min(float(np.hypot(*now[pair])) for pair in (*PLACES, *SPEEDS))
    assert float(new @ matrix @ new) < 2.0 * stiff * (1.0 / (near**2 + UNIT_M**2)) ** 2 + 1e-9
    assert float(np.linalg.eigvalsh(matrix)[0]) > -1e-9 * float(np.abs(matrix).max())


@given(seeds)
def test_pairs_are_changed_as_by_the_whole_matrix_of_the_change(seed: int) -> None:
    chance = np.random.default_rng(seed)
    half, vector = chance.normal(0.0, 1.0, (NUMBERS, NUMBERS)), chance.normal(0.0, 1.0, NUMBERS)
    matrix, changes, whole = half @ half.T, chance.normal(0.0, 1.0, (len(PLACES), 2, 2)), np.eye(NUMBERS)
    for pair, change in zip(PLACES, changes, strict=True):
        whole[np.ix_(pair, pair)] = change
    expected = whole.T @ matrix @ whole, whole.T @ vector
    change_pairs(matrix, vector, PLACES, changes)
    assert matrix == pytest.approx(expected[0])
    assert vector == pytest.approx(expected[1])


def test_a_place_that_has_jumped_is_left_as_it_was_said() -> None:
    was, now = np.array([10.0, 0.0]), np.array([0.0, 10.0])
    assert turned_along(was, now, np.array([[0, 1]]), BASE_M)[0] == pytest.approx(np.eye(2))


@given(seeds, st.floats(-50.0, 50.0), st.floats(-50.0, 50.0))
def test_the_map_turns_about_what_does_not_move_with_it(seed: int, east_m: float, north_m: float) -> None:
    """Readings tell of any change but a turn about one place."""
    chance, held_m = np.random.default_rng(seed), np.array([east_m, north_m])
    reference = chance.normal(0.0, 30.0, NUMBERS)
    free = turn_about(reference, CHANGED, held_m)
    rows = chance.normal(0.0, 1.0, (12, NUMBERS))
    rows -= np.outer(rows @ free, free) / (free @ free)
    found_m = pivot(rows.T @ rows, reference, CHANGED, BASE_M)
    assert found_m == pytest.approx(held_m, abs=0.1)


def test_where_no_reading_holds_the_map_it_turns_about_the_base() -> None:
    base_m, none = np.array([3.0, -4.0]), np.zeros(0, dtype=np.intp)
    alone = Turning(np.array([[0, 1]]), none.reshape(0, 2), none)
    assert pivot(np.zeros((2, 2)), np.ones(2), alone, base_m) == pytest.approx(base_m)
