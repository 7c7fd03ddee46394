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


@pytest.mark.parametrize("up_m", [-2.6, 0.2, 3.0])
def test_who_is_not_heard_of_stays_on_his_storey_though_its_probability_falls(up_m: float) -> None:
    """Were the lowest storey all that is below, whose height may be anything would be in the cellar."""
    found = [most_probable(HOUSE, up_m, sigma_m**2) for sigma_m in (0.3, 2.0, 5.0, 20.0, 100.0)]
    assert len({storey.level for storey in found if storey is not None}) == 1
    last = found[-1]
    assert last is not None
    assert last.probability == pytest.approx(1.0 / 3.0, abs=0.05)


def test_far_below_the_cellar_and_far_above_the_roof_the_nearest_storey_counts() -> None:
    below, above = most_probable(HOUSE, -40.0, 0.01), most_probable(HOUSE, 40.0, 0.01)
    assert below == (-1, "cellar", 1.0)
    assert above == (1, "first", 1.0)


def test_without_storeys_there_is_none_and_one_storey_is_certain() -> None:
    assert most_probable([], 1.0, 1.0) is None
    assert most_probable([(0, "ground", 0.0)], 40.0, 1.0) == (0, "ground", 1.0)
