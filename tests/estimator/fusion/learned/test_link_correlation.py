"""The newest reading on each link."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion import physics
from estimator.fusion.learned.link_correlation import (
    ALIKE,
    ERROR,
    KEPT,
    NEW,
    WALLS_M,
    Links,
    follow,
    power_sigma,
)
from estimator.graph.dense import Array

FACTOR, SHARED, NOMINAL_DB = 1.2, 0.4, 5.0
COMMON_DB2, WHITE_DB2 = SHARED * (FACTOR * NOMINAL_DB) ** 2, (1.0 - SHARED) * (FACTOR * NOMINAL_DB) ** 2


def sigmas_db(ways_m: Array) -> Array:
    """What is given to the powers of a link, one at each of these ways along, m (dB)."""
    link, found = np.array(NEW), list[float]()
    for way_m in ways_m.tolist():
        follow(link, 0.0, way_m)
        found.append(power_sigma(link, FACTOR, SHARED, NOMINAL_DB))
    return np.array(found)


@given(st.lists(st.floats(0.0, 10.0), min_size=1, max_size=12))
def test_powers_of_a_link_count_together_for_what_their_covariance_says_of_a_number_that_all_are_off_by(
    steps_m: list[float],
) -> None:
    """Against the covariance of all of them, inverted whole."""
    ways_m = np.cumsum(steps_m)
    kept = np.exp(-np.abs(ways_m[:, None] - ways_m) / physics.SHARED_M)
    covariance = COMMON_DB2 * kept + WHITE_DB2 * np.eye(len(ways_m))
    ones = np.ones(len(ways_m))
    assert (sigmas_db(ways_m) ** -2).sum() == pytest.approx(ones @ np.linalg.solve(covariance, ones))


def test_powers_at_one_place_are_worth_one_that_is_off_by_what_they_share() -> None:
    count = 1000
    together = (sigmas_db(np.zeros(count)) ** -2).sum()
    assert together == pytest.approx(count / (WHITE_DB2 + count * COMMON_DB2))


def test_each_power_on_a_long_way_counts_for_as_much_as_the_others() -> None:
    each_m = 0.5
    late = sigmas_db(each_m * np.arange(100.0))[50:]
    kept = math.exp(-each_m / physics.SHARED_M)
    worth = 1.0 / (WHITE_DB2 + COMMON_DB2 * (1.0 + kept) / (1.0 - kept))
    assert late == pytest.approx(late[0])
    assert late[0] ** -2 == pytest.approx(worth, rel=0.1)


def test_a_link_forgets_its_error_once_an_end_has_walked_a_room_on() -> None:
    link = np.array(NEW)
    for second in range(10):
        follow(link, float(second), 0.0)
    assert link[ALIKE] == pytest.approx(10.0, rel=0.1)
    follow(link, 10.0, 30.0)
    assert link[ALIKE] == pytest.approx(1.0, abs=0.01)


def test_what_walls_add_on_a_link_is_that_of_its_newest_range_and_goes_as_an_end_walks_on() -> None:
    links = Links()
    for name in ("b1", "b2"):
        links.number("uwb", "ff", name)
    links.tell_walls(np.array([0, -1, 0]), np.array([9.0, 8.0, 0.5]), np.full(3, 0.25), np.full(3, 0.04))
    assert links.table[:, WALLS_M].tolist() == [0.5, 0.0]
    follow(links.table[0], 0.0, 0.0)
    links.tell_walls(np.array([0]), np.array([0.5]), np.array([0.25]), np.array([0.04]))
    follow(links.table[0], 0.0, physics.SHARED_M)
    assert links.table[0, WALLS_M:] == pytest.approx(np.array([0.5, 0.25, 0.04]) / math.e)
    links.renew("b1")
    assert not links.table[0, WALLS_M:].any()


def test_the_first_reading_on_a_link_shares_its_error_with_none() -> None:
    link = np.array(NEW)
    follow(link, 1.7e9, 40.0)
    assert link[ALIKE] == 1.0
    assert link[KEPT] == 0.0
    assert np.isnan(link[ERROR])


def test_a_link_is_the_same_in_either_direction_and_keeps_its_row_as_the_table_grows() -> None:
    links = Links()
    for name in range(40):
        assert links.number("uwb", "ff", f"b{name}") == name
        links.table[name, ERROR] = name
    assert links.number("uwb", "b7", "ff") == 7
    assert links.number("rtt", "b7", "ff") == 40
    assert links.table[:40, ERROR].tolist() == list(range(40))


def test_a_node_that_lies_elsewhere_has_other_errors_on_its_links_and_on_no_others() -> None:
    links = Links()
    for a, b in (("b1", "ff"), ("b1", "b2"), ("b2", "ff")):
        links.number("uwb", a, b)
    for link in links.table:
        follow(link, 5.0, 0.0)
    links.renew("b1")
    assert links.table[:, ALIKE].tolist() == [0.0, 0.0, 1.0]
    assert links.number("uwb", "ff", "b1") == 0


def test_a_copy_shares_nothing_that_changes() -> None:
    links = Links()
    links.number("uwb", "a", "b")
    twin = links.copy()
    follow(twin.table[0], 5.0, 0.0)
    twin.number("uwb", "a", "c")
    assert len(links.numbers) == 1
    assert links.table[0, ALIKE] == 0.0
