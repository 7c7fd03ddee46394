"""Encounters: the strongest reading of a link while somebody passes."""

import numpy as np

from estimator.smoothing.readings.encounters import candidates


def test_only_the_strongest_reading_of_a_pass_is_a_candidate() -> None:
    t = np.arange(11.0)
    value = -50.0 - 3.0 * np.abs(t - 5.0)
    assert np.flatnonzero(candidates(t, np.zeros(11), value)).tolist() == [5]


def test_each_link_has_its_own_passes() -> None:
    t = np.tile(np.arange(7.0), 2)
    link = np.repeat([1.0, 2.0], 7)
    value = -50.0 - np.concatenate([np.abs(t[:7] - 2.0), np.abs(t[7:] - 4.0)])
    assert np.flatnonzero(candidates(t, link, value)).tolist() == [2, 11]


def test_a_single_reading_is_no_pass() -> None:
    assert not candidates(np.array([3.0]), np.array([1.0]), np.array([-30.0])).any()


def test_passes_are_the_same_in_whatever_order_the_readings_come() -> None:
    """Two links heard in turns, and one reading that is of none: by epoch, link by link, and shuffled."""
    chance = np.random.default_rng(2)
    t = np.repeat(np.arange(30.0), 2)
    link = np.tile([4.0, 2.0], 30)
    value = -50.0 - 3.0 * np.abs(t - np.where(link == 4.0, 8.0, 21.0))
    t, link, value = np.r_[t, 40.0], np.r_[link, -1.0], np.r_[value, -20.0]
    passed = candidates(t, link, value)
    assert sorted(zip(link[passed].tolist(), t[passed].tolist(), strict=True)) == [(2.0, 21.0), (4.0, 8.0)]
    for order in (np.lexsort((t, link)), chance.permutation(len(t))):
        assert (candidates(t[order], link[order], value[order]) == passed[order]).all()


def test_where_nothing_was_heard_nobody_passes() -> None:
    nothing = np.zeros(0)
    assert candidates(nothing, nothing, nothing).shape == (0,)
