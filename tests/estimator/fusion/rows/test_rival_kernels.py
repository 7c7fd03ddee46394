"""The rivals of units after the ranges of a tick."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from estimator.fusion.learned import rival
from estimator.fusion.learned.rival import COVARIANCE, STATE, Rival, T
from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.fusion.rows.prediction import predict
from estimator.fusion.rows.rival_kernels import (
    LINKS,
    ODDS,
    RANGED,
    RivalUpdate,
    rivals_of,
    told_by_links,
    units_from,
    update_rivals,
)
from estimator.fusion.rows.rows import Row, table_of
from estimator.graph.dense import Array

UNITS, BREADCRUMB, TECHNOLOGY = (0, 6), 3, 9
X = np.array([1.0, 2.0, 0.0, 8.0, -3.0, 0.5, 20.0, 0.0, 0.0, 0.2, 0.01])
POSE_T = np.array([7.5, 8.0])
NOBODY = (None, None)


def ranged(unit: int, link: int, range_m: float = 9.0) -> Row:
    return Row(RANGE, unit, range_m, 0.2, 0.1, 1.5, 3.0, 0.3, BREADCRUMB, TECHNOLOGY, link=link, b_e=5.0)


def heard(unit: int, link: int, power_dbm: float = -70.0) -> Row:
    return Row(
        RSSI, unit, power_dbm, 40.0, 0.05, -8.0, 12.0, 6.0, BREADCRUMB, TECHNOLOGY, constant=-45.0, link=link
    )


def follow(*rows: Row, pose_t: Array = POSE_T, rivals: Sequence[Rival | None] = NOBODY) -> RivalUpdate:
    table = table_of({}, [], np.array(rows, dtype=np.float64))
    units = units_from([(start, t, True) for start, t in zip(UNITS, pose_t, strict=True)], rivals)
    half = np.random.default_rng(5).normal(0.0, 1.0, (len(X), len(X)))
    seen = predict(table, half @ half.T + np.eye(11), np.zeros(11), X)
    return update_rivals(table, np.full(len(rows), 7.0), units, seen, X)


def told(*ranges: tuple[int, float]) -> Array:
    """Ranges of links at epochs (s)."""
    found = np.zeros((len(ranges), rival.TOLD))
    found[:, [rival.LINK, rival.EPOCH]] = ranges
    return found


def test_a_believed_unit_takes_its_rival_along() -> None:
    found = follow(ranged(UNITS[0], 1)).rivals[0]
    assert found[T] == 7.5
    assert found[ODDS] < rival.RARE + 1.0
    assert math.dist(found[STATE][:2].tolist(), X[:2].tolist()) < 5.0
    assert found[COVARIANCE][0] > 0.0


def test_units_of_one_tick_are_followed_as_each_alone() -> None:
    rows = ranged(UNITS[0], 1), ranged(UNITS[1], 4, 12.0), ranged(UNITS[0], 2)
    both, first, second = follow(*rows), follow(rows[0], rows[2]), follow(rows[1])
    np.testing.assert_allclose(both.rivals[0], first.rivals[0])
    np.testing.assert_allclose(both.rivals[1], second.rivals[1])
    np.testing.assert_allclose(both.links, np.vstack([first.links, second.links]))
    assert both.links[:, 0].tolist() == [1.0, 2.0, 4.0]
    assert both.rivals[:, LINKS].tolist() == [2.0, 1.0]


def test_a_rival_goes_on_from_where_it_was() -> None:
    before = follow(ranged(UNITS[0], 1))
    after = follow(ranged(UNITS[0], 2), pose_t=POSE_T + 1.0, rivals=list(rivals_of(before)))
    assert after.rivals[0, T] == 8.5
    assert after.links[:, 0].tolist() == [1.0, 2.0]
    assert after.rivals[0, ODDS] == rival.odds_of(after.links, 8.5)


def test_of_whom_is_not_asked_there_is_no_rival_and_yet_he_was_heard() -> None:
    found = follow(ranged(UNITS[0], 1), pose_t=np.array([math.nan, 8.0]))
    assert found.heard
    assert np.isnan(found.rivals).all()
    assert not len(found.links)
    assert not follow(ranged(UNITS[0], -1)).heard


def heard_more(known: Array, told: Array, gains: list[float]) -> Array:
    """What links tell with more readings."""
    links: Array = told_by_links(known, told, np.array(gains))
    return links


def test_a_link_that_is_heard_again_at_once_tells_nothing_more() -> None:
    once = heard_more(np.zeros((0, 3)), told((3, 5.0)), [2.0])
    twice = heard_more(once, told((3, 5.0)), [2.0])
    later = heard_more(once, told((3, 5.0 + rival.SPELL_S)), [2.0])
    assert once.tolist() == twice.tolist() == [[3.0, 5.0, 2.0]]
    assert later[0, 2] == pytest.approx(2.0 + 2.0 * math.exp(-rival.SPELL_S / rival.MEMORY_S))


def test_links_stand_in_order_and_are_forgotten_once_they_have_long_been_silent() -> None:
    known = np.array([[2.0, 0.0, 1.0], [7.0, 15.0, 1.0]])
    found = heard_more(known, told((9, 25.0), (1, 25.0)), [20.0, -20.0])
    assert found.tolist() == [[1.0, 25.0, rival.LEAST], [7.0, 15.0, 1.0], [9.0, 25.0, rival.MOST]]


def test_it_is_known_when_a_rival_was_last_ranged_however_much_was_heard_since() -> None:
    silent = follow(heard(UNITS[0], 1))
    ranged_at_7 = follow(ranged(UNITS[0], 1), heard(UNITS[0], 2))
    later = follow(heard(UNITS[0], 1), pose_t=POSE_T + 1.0, rivals=list(rivals_of(ranged_at_7)))
    assert [found.rivals[0, RANGED] for found in (silent, ranged_at_7, later)] == [-math.inf, 7.0, 7.0]


def test_rivals_of_several_units_are_theirs_again_in_the_next_tick() -> None:
    found = follow(ranged(UNITS[0], 1), ranged(UNITS[0], 2), ranged(UNITS[1], 4))
    first, second = rivals_of(found)
    assert first is not None
    assert second is not None
    assert np.frombuffer(first.links)[::3].tolist() == [1.0, 2.0]
    assert np.frombuffer(second.links)[::3].tolist() == [4.0]
    units = units_from([(0.0, 0.0, True)] * 3, [first, None, second])
    assert np.array_equal(units.links, found.links)
    assert np.array_equal(units.ways[::2], found.rivals[:, : rival.WAY])
    assert units.rows[:, -2:].tolist() == [[7.0, 2.0], [-math.inf, 0.0], [7.0, 1.0]]


def test_of_whom_nothing_is_told_there_is_no_rival() -> None:
    assert [one is None for one in rivals_of(follow(ranged(UNITS[1], 1)))] == [True, False]
