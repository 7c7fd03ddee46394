"""Storeys and their probability."""

import pytest

from estimator.levels import most_probable

HOUSE = [(1, "first", 3.2), (0, "ground", 0.0), (-1, "cellar", -2.8)]


def test_a_sure_height_gives_its_storey_with_certainty() -> None:
    found = most_probable(HOUSE, 3.3, 0.01)
    assert found is not None
    assert (found.level, found.name) == (1, "first")
    assert found.probability == pytest.approx(1.0)


def test_a_height_halfway_between_two_floors_is_even() -> None:
    found = most_probable(HOUSE, 1.6, 0.25)
    assert found is not None
    assert found.probability == pytest.approx(0.5, abs=1e-3)


def test_probabilities_fall_as_the_height_becomes_unsure() -> None:
    shares = [most_probable(HOUSE, 0.0, sigma**2) for sigma in (0.2, 1.0, 2.0, 5.0)]
    values = [s.probability for s in shares if s is not None]
    assert values == sorted(values, reverse=True)
    assert len(values) == 4


def test_without_storeys_there_is_none_and_one_storey_is_certain() -> None:
    assert most_probable([], 1.0, 1.0) is None
    assert most_probable([(0, "ground", 0.0)], 40.0, 1.0) == (0, "ground", 1.0)
