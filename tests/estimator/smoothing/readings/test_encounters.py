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
