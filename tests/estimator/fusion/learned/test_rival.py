"""The way by ranges or powers alone, beside the one that a unit tells."""

import math

import numpy as np
import pytest

from estimator.fusion.learned import rival
from estimator.fusion.learned.rival import Rival
from estimator.fusion.motion.constant_velocity import free_motion
from estimator.graph.dense import Array
from estimator.graph.symmetric import upper_of

PLANE = [0, 1, 3, 4]
RADIOS_M = np.array([[30.0, 0.0], [-10.0, 25.0], [-10.0, -25.0]])


def told(link: int, t: float, place_m: Array, off_m: float = 0.0, excess_m: float = 0.0) -> list[float]:
    """A range to a radio, measured at a place, which is `off_m` longer than the unit's way foretells."""
    east, north = RADIOS_M[link].tolist()
    distance = math.dist(place_m.tolist(), (east, north)) + excess_m
    return [0.0, float(link), t, distance, 0.2, 0.0, east, north, 0.0, 0.1, off_m, 0.05, 0.0]


def heard(link: int, t: float, place_m: Array, off_db: float = 0.0) -> list[float]:
    """A power of a radio, heard at a place, `off_db` stronger than the unit's way foretells."""
    east, north = RADIOS_M[link].tolist()
    db = -25.0 * math.log10(math.hypot(place_m[0] - east, place_m[1] - north, 0.3))
    return [0.0, float(link), t, db, 6.0, 1.0, east, north, 0.0, 0.05, off_db, 1.0, 2.5]


def test_it_goes_on_as_who_has_no_unit() -> None:
    state, covariance = np.array([3.0, -2.0, 1.0, 0.5]), np.diag([0.4, 0.3, 0.2, 0.1])
    transition, noise = (matrix[np.ix_(PLANE, PLANE)] for matrix in free_motion("responder", 2.5))
    moved, unsure = rival.predicted(state, covariance, 2.5)
    np.testing.assert_allclose(moved, transition @ state)
    np.testing.assert_allclose(unsure, transition @ covariance @ transition.T + noise)


def test_it_follows_ranges_to_where_they_are_measured() -> None:
    way_m = np.column_stack([np.linspace(0.0, 10.0, 11), np.zeros(11)])
    ranges = np.array([told(i, float(t), way_m[t]) for t in range(11) for i in range(3)])
    found, covariance, t = rival.follow(np.zeros(4), upper_of(np.eye(4)), 0.0, ranges, np.empty(33))
    assert t == 10.0
    assert math.dist(found[:2].tolist(), way_m[-1].tolist()) < 0.3
    assert covariance[0, 0] < 0.1


def test_it_follows_powers_to_where_they_are_heard() -> None:
    powers = np.array([heard(i, float(t), np.array([8.0, -6.0])) for t in range(30) for i in range(3)])
    found, covariance, _ = rival.follow(np.zeros(4), upper_of(np.eye(4)), 0.0, powers, np.empty(90))
    off_m = found[:2] - (8.0, -6.0)
    assert np.hypot(*off_m) < 4.0
    assert off_m @ np.linalg.solve(covariance[:2, :2], off_m) < 4.0


def test_who_foretells_a_power_gains_by_it_and_less_than_by_a_range() -> None:
    gains = np.empty(2)
    powers = np.array([heard(0, 0.0, np.zeros(2)), heard(1, 0.0, np.zeros(2), off_db=-18.0)])
    rival.follow(np.zeros(4), upper_of(np.eye(4)), 0.0, powers, gains)
    assert gains[0] < 0.0
    assert 1.0 < gains[1] < 5.0


def test_a_power_is_too_weak_rather_than_too_strong() -> None:
    by_weaker, _ = rival.likely_power(-25.0, 36.0, 0.1)
    by_stronger, _ = rival.likely_power(25.0, 36.0, 0.1)
    assert by_weaker > 3.0 * by_stronger


def test_an_obstructed_range_hardly_pulls_it() -> None:
    ranges = np.array([told(0, 1.0, np.zeros(2), excess_m=8.0)])
    found, *_ = rival.follow(np.zeros(4), upper_of(0.1 * np.eye(4)), 1.0, ranges, np.empty(1))
    assert np.abs(found[:2]).max() < 0.2


def test_a_range_is_too_long_rather_than_too_short() -> None:
    by_longer, _ = rival.likely(2.0, 0.04, 0.1)
    by_shorter, _ = rival.likely(-2.0, 0.04, 0.1)
    assert by_longer > 20.0 * by_shorter


def test_a_density_of_ranges_is_one() -> None:
    off_m = np.linspace(-200.0, 200.0, 400_001)
    total = np.sum([rival.likely(one, 0.25, 0.2)[0] for one in off_m[::10]]) * 10 * (off_m[1] - off_m[0])
    # Where it ends on the short side is no jump: what that adds is no more than the noise is wide.
    assert total == pytest.approx(1.0, abs=0.1)


def test_who_foretells_a_range_gains_by_it() -> None:
    gains = np.empty(2)
    good, bad = told(0, 0.0, np.zeros(2), off_m=0.1), told(1, 0.0, np.zeros(2), off_m=-3.0)
    rival.follow(np.zeros(4), upper_of(np.eye(4)), 0.0, np.array([good, bad]), gains)
    assert gains[0] < 0.0
    assert gains[1] > 3.0


def known(*gains: float) -> Rival:
    links = np.array([(float(i), 10.0, gain) for i, gain in enumerate(gains)]).reshape(-1, 3)
    way = np.array([10.0, 4.0, 0.0, 0.0, 0.0, *upper_of(np.eye(4))])
    return Rival(way.tobytes(), links.tobytes(), rival.odds_of(links, 10.0))


def numbers(links: bytes) -> Array:
    return np.frombuffer(links).reshape(-1, 3).copy()


def test_one_link_alone_tells_nothing_of_a_unit() -> None:
    assert known(rival.MOST).odds == known().odds == rival.RARE
    assert known(rival.MOST, rival.MOST, rival.MOST).odds > 4.0


def test_what_links_have_told_is_forgotten() -> None:
    found = known(4.0, 4.0, 4.0)
    assert rival.odds_of(numbers(found.links), 10.0 + 3.0 * rival.MEMORY_S) < rival.RARE + 1.0


def test_the_covariance_holds_a_rival_as_far_as_it_is_likely() -> None:
    likely, unlikely = known(5.0, -rival.RARE), known(-1.0, -1.0)
    added = likely.doubt_m2(np.zeros(2), 10.0)
    np.testing.assert_allclose(added, likely.share * np.diag([1.0 + 4.0**2, 1.0]))
    assert likely.share == pytest.approx(0.5)
    assert not unlikely.doubt_m2(np.zeros(2), 10.0).any()
