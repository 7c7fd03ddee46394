"""What ranges are too long by through walls, told by how they scatter, and by nothing else."""

from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.smoothing.readings.obstructed import Excess, excess
from tests.estimator.smoothing.windows import fused, problem_of
from tests.estimator.walks import behind_a_wall

READINGS, LINKS = 40, 12


class Heard(NamedTuple):
    """Ranges on some links of people who stand: their links, rows of alike readings, errors (m)."""

    link: Integers
    alike: Array
    error_m: Array


def told(ranges: Heard, error_m: Array | None = None, steep_m: float = 0.0) -> Excess:
    """What they are told to be too long by, with both ends of each so much apart in height."""
    error_m = ranges.error_m if error_m is None else error_m
    return excess(ranges.link, ranges.alike, error_m, np.full(len(error_m), steep_m))


def heard(sigma_m: float, excess_m: list[float], seed: int = 0) -> Heard:
    """Each link with its own mean excess, which is exponential."""
    chance = np.random.default_rng(seed)
    link = np.tile(np.arange(len(excess_m)), READINGS)
    alike = np.repeat(np.arange(1.0, READINGS + 1.0), len(excess_m))
    mean = np.array(excess_m)[link]
    return Heard(
        link, alike, chance.normal(0.0, sigma_m, len(link)) + mean * chance.exponential(1.0, len(link))
    )


@settings(deadline=None)
@given(st.integers(0, 1000), st.sampled_from([0.03, 0.1, 0.15]))
def test_a_link_that_scatters_is_too_long_and_a_clear_one_is_not(seed: int, sigma_m: float) -> None:
    walls = [0.0] * 8 + [0.5] * 4
    ranges = heard(sigma_m, walls, seed)
    found = told(ranges)
    clear = np.array(walls)[ranges.link] == 0.0
    assert found.mean_m[clear].mean() < 0.05
    assert 0.15 < found.mean_m[~clear].mean() < 0.9
    assert (found.scatter_m2 >= found.mean_m**2 - 1e-12).all()
    assert (found.doubt_m2 >= 0.0).all()


@pytest.mark.parametrize("too_long_m", [0.5, -0.5, 3.0])
def test_lengths_alone_tell_nothing_for_a_map_may_be_wrong(too_long_m: float) -> None:
    ranges = heard(0.1, [0.0] * LINKS)
    wrong = ranges.error_m + np.where(ranges.link < 4, too_long_m, 0.0)
    same = told(ranges, wrong)
    assert same.mean_m == pytest.approx(told(ranges).mean_m, abs=1e-9)


@pytest.mark.parametrize("sigma_m", [0.02, 0.1, 0.5, 1.5])
def test_a_noisy_radio_is_no_wall(sigma_m: float) -> None:
    ranges = heard(sigma_m, [0.0] * LINKS)
    assert told(ranges).mean_m.mean() < 0.1


def test_where_most_links_are_obstructed_the_clear_ones_are_still_told_apart() -> None:
    walls = [0.0] * 4 + [1.0] * 8
    ranges = heard(0.1, walls, 1)
    found = told(ranges)
    clear = np.array(walls)[ranges.link] == 0.0
    assert found.mean_m[clear].mean() < 0.1
    assert found.mean_m[~clear].mean() > 0.7


def test_one_odd_reading_makes_no_wall_of_its_link() -> None:
    ranges = heard(0.1, [0.0] * LINKS)
    ranges.error_m[5 * LINKS + 3] += 4.0
    found = told(ranges)
    assert found.mean_m[ranges.link == 3].max() < 0.1


def test_who_has_moved_on_looks_through_other_walls() -> None:
    """A row of alike readings that begins anew is told by itself."""
    ranges = heard(0.1, [0.0] * 8 + [1.0] * 4, 2)
    late = np.repeat(np.arange(READINGS), LINKS) >= READINGS // 2
    alike = np.where(late, ranges.alike - READINGS // 2, ranges.alike)
    quiet = np.where(late, heard(0.1, [0.0] * LINKS, 3).error_m, ranges.error_m)
    found = excess(ranges.link, alike, quiet, np.zeros(len(quiet)))
    walls = ranges.link >= 8
    assert found.mean_m[walls & ~late].mean() > 0.5
    assert found.mean_m[walls & late].mean() < 0.1


def test_a_scattering_range_is_of_a_floor_the_likelier_the_more_its_ends_differ_in_height() -> None:
    few = heard(0.1, [0.0] * 8 + [0.5] * 4, 5)
    # Whoever climbs looks through another part of the floor after some steps.
    few = few._replace(alike=(few.alike - 1.0) % 3.0 + 1.0)
    level, stair = told(few), told(few, steep_m=1.5)
    floor = few.link >= 8
    assert abs(stair.mean_m[floor].mean() - 0.5) < abs(level.mean_m[floor].mean() - 0.5)
    assert stair.mean_m[floor].mean() > level.mean_m[floor].mean() + 0.05
    assert stair.mean_m[~floor].mean() < 0.5 * stair.mean_m[floor].mean()


@pytest.mark.parametrize("count", [0, 1, 30])
def test_a_few_readings_tell_of_no_wall(count: int) -> None:
    link, alike = np.zeros(count, dtype=np.int64), np.arange(1.0, count + 1.0)
    error_m = np.random.default_rng(1).exponential(1.0, count)
    assert not excess(link, alike, error_m, np.zeros(count)).mean_m.any()


def test_a_window_takes_off_its_ranges_what_they_are_too_long_by_and_believes_them_less() -> None:
    """Those to anchors lose it with all of their crew."""
    problem = problem_of(fused(behind_a_wall()))
    rows, solved = problem.rows, problem.solve(problem.layout.start())
    raw, sigma = rows.residual(solved.x), rows.sigma
    rows, walls = rows.obstructed(solved.x, np.ones(len(raw), dtype=np.bool_))
    to_anchors = rows.readings.lost != 0.0
    assert walls.mean_m[to_anchors].any()
    assert rows.shift[: len(walls.mean_m)] == pytest.approx(np.where(to_anchors, 0.0, walls.mean_m))
    assert not rows.shift[len(walls.mean_m) :].any()
    assert rows.residual(solved.x) == pytest.approx(raw - rows.shift)
    rows.widen(solved.x, problem.linearise(solved.x).jacobian)
    told = rows.shift > 0.3
    beacon = np.array([problem.layout.state.owners.index("beacon")])
    assert np.isin(rows.pairs[told[: len(rows.pairs)].nonzero()[0], 2:4], beacon).any(axis=1).all()
    assert told.sum() > 60
    assert (rows.sigma[told] ** -2).sum() < 0.8 * (sigma[told] ** -2).sum()
