"""How simulated responders are introduced."""

import numpy as np
import pytest

from estimator.simulate.team import CRAWLS, RISES, START_SIGMA_M, introduce, typical_unit
from estimator.simulate.walking import walk


def test_a_place_said_to_be_known_to_half_a_metre_is_off_by_about_that() -> None:
    truth = walk((3.0, -2.0, 0.0), (), (), 1.0)
    told = [introduce("ff1", truth, np.random.default_rng(seed)).position_m for seed in range(400)]
    off_m = np.array([place for place in told if place is not None]) - truth.position_m[0]
    assert np.std(off_m[:, :2], axis=0) == pytest.approx([START_SIGMA_M] * 2, rel=0.1)
    assert np.abs(off_m[:, :2].mean(axis=0)).max() < 0.1
    assert not off_m[:, 2].any()


def test_where_somebody_is_said_to_be_changes_nothing_in_what_is_drawn_afterwards() -> None:
    untouched, used = np.random.default_rng(1), np.random.default_rng(1)
    introduce("ff1", walk((0.0, 0.0, 0.0), (), (), 1.0), used)
    assert used.normal() == untouched.normal()


def test_what_a_boot_makes_of_heights_and_of_crawls_changes_nothing_in_what_is_drawn_afterwards() -> None:
    units = [typical_unit(np.random.default_rng(seed)) for seed in range(400)]
    assert np.std([unit.rises for unit in units]) == pytest.approx(RISES, rel=0.1)
    assert np.std([unit.crawls for unit in units]) == pytest.approx(CRAWLS, rel=0.1)
    assert np.mean([unit.crawls for unit in units]) == pytest.approx(1.0, abs=0.01)
    drawn, used = np.random.default_rng(1), np.random.default_rng(1)
    drawn.normal(size=2)
    typical_unit(used)
    assert used.normal() == drawn.normal()
