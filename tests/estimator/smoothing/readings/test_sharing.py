"""How many powers of a link share an error, as the smoothed view counts them."""

import math

import numpy as np
import pytest

from estimator.fusion import physics
from estimator.fusion.learned.link_correlation import ALIKE, NEW, follow
from estimator.fusion.memory.ledger import COLUMNS, RANGE, RSSI
from estimator.graph.dense import Array
from estimator.smoothing.readings import sharing
from estimator.smoothing.readings.sharing import KIND, LINK

EACH_M = 0.5


def powers_sharing(table: Array, alike: Array) -> Array:
    """Of who has no unit."""
    return sharing.powers_sharing(table, alike, np.ones(len(table), dtype=np.bool_))


def pairs(ways_m: Array, kind: int, link: int) -> tuple[Array, Array]:
    """Readings of a link, one at each of these ways along (m), and which number in its row each is."""
    table, known, alike = np.zeros((len(ways_m), len(COLUMNS["pairs"]))), np.array(NEW), list[float]()
    table[:, KIND], table[:, LINK] = kind, link
    for way_m in ways_m.tolist():
        follow(known, 0.0, way_m)
        alike.append(float(known[ALIKE]))
    return table, np.array(alike)


def test_powers_at_one_place_share_their_error_with_all_that_are_heard_there() -> None:
    assert powers_sharing(*pairs(np.zeros(20), RSSI, 0)) == pytest.approx(np.full(20, 20.0))


def test_a_power_on_a_long_way_shares_its_error_with_those_before_and_after_it_as_far_as_they_do() -> None:
    ways_m = EACH_M * np.arange(200.0)
    shared = np.exp(-np.abs(ways_m[:, None] - ways_m) / physics.SHARED_M).sum(axis=1)
    assert powers_sharing(*pairs(ways_m, RSSI, 3)) == pytest.approx(shared)
    kept = math.exp(-EACH_M / physics.SHARED_M)
    assert shared[100] == pytest.approx((1.0 + kept) / (1.0 - kept), rel=1e-4)


def test_each_link_counts_its_own_powers_and_no_ranges() -> None:
    here, alike_here = pairs(np.zeros(5), RSSI, 1)
    there, alike_there = pairs(EACH_M * np.arange(5.0), RSSI, 0)
    ranged, alike_ranged = pairs(np.zeros(5), RANGE, 2)
    order = np.argsort([*range(0, 15, 3), *range(1, 15, 3), *range(2, 15, 3)])
    mixed = np.concatenate([here, there, ranged])[order]
    found = np.empty(15)
    found[order] = powers_sharing(mixed, np.concatenate([alike_here, alike_there, alike_ranged])[order])
    assert found[:5] == pytest.approx(np.full(5, 5.0))
    assert found[5:10] == pytest.approx(powers_sharing(there, alike_there))
    assert (found[10:] == 0.0).all()


def test_who_has_a_unit_is_weighed_as_his_ranges_are() -> None:
    table, alike = pairs(np.zeros(6), RSSI, 0)
    drifts = np.array([True, False, True, False, True, False])
    found = sharing.powers_sharing(table, alike, drifts)
    assert (found[~drifts] == 0.0).all()
    assert (found[drifts] > 0.0).all()


def test_nothing_is_shared_where_nothing_was_read() -> None:
    assert len(powers_sharing(np.zeros((0, len(COLUMNS["pairs"]))), np.zeros(0))) == 0


def test_errors_in_a_row_are_shared_by_as_many_as_what_is_kept_between_them_adds_up_to() -> None:
    kept = np.random.default_rng(4).uniform(0.0, 1.0, 9)
    at = np.concatenate([[0.0], np.cumsum(-np.log(kept))])
    shared = np.exp(-np.abs(at[:, None] - at)).sum(axis=1)
    assert sharing.sharing_counts(kept) == pytest.approx(shared)
