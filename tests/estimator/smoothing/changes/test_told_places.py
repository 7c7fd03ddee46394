"""What everything else says of a told place, against evidence and solutions that are worked out in full."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from estimator.fusion import physics
from estimator.graph.dense import Array
from estimator.smoothing.changes.told_places import (
    CLEARER,
    LEAST_M,
    RARELY,
    ToldPlace,
    doubts_of,
    judged,
    mistold,
)

TOLD_M, SIGMA_M, WIDE_M = np.array([4.0, -2.0]), 0.1, physics.MISTOLD_SIGMA_M


def readings(seed: int) -> tuple[Array, Array]:
    """Kirchhoff matrix and b of a place and of two more unknowns, by all but what was told of the place."""
    chance = np.random.default_rng(seed)
    rows = chance.normal(0.0, 3.0, (6, 4))
    seen = rows @ np.array([*TOLD_M, 1.0, 1.0]) + 3.0 * chance.normal(0.0, 1.0, 6)
    return rows.T @ rows, rows.T @ seen


def solved(seed: int, sigma_m: float) -> tuple[Array, Array]:
    """Estimate and covariance with the place told with a standard deviation."""
    matrix, vector = readings(seed)
    known = np.array([sigma_m**-2.0, sigma_m**-2.0, 0.0, 0.0])
    covariance = np.asarray(np.linalg.inv(matrix + np.diag(known)), dtype=np.float64)
    return covariance @ (vector + known * np.array([*TOLD_M, 0.0, 0.0])), covariance


def asked(seed: int) -> ToldPlace:
    """What is found of the place."""
    x, covariance = solved(seed, SIGMA_M)
    return judged("a", 3, x[:2] - TOLD_M, covariance[:2, :2], np.full(2, SIGMA_M))


def place(name: str, odds: float, off_m: float = 3.0) -> ToldPlace:
    """A told place that may be wrong."""
    return ToldPlace(name, 0, odds, np.array([off_m, 0.0]), np.diag([4.0, 1.0]))


@pytest.mark.parametrize("seed", range(6))
def test_odds_are_those_of_what_all_readings_say_of_it(seed: int) -> None:
    matrix, vector = readings(seed)
    apart = np.linalg.inv(matrix)
    said_m, unsure = (apart @ vector)[:2], apart[:2, :2]
    wrong, right = (
        multivariate_normal.logpdf(said_m, TOLD_M, unsure + sigma_m**2 * np.eye(2))
        for sigma_m in (WIDE_M, SIGMA_M)
    )
    assert asked(seed).odds == pytest.approx(RARELY + wrong - right, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_where_it_stands_if_it_is_wrong_is_where_a_solution_without_it_puts_it(seed: int) -> None:
    x, covariance = solved(seed, SIGMA_M)
    there, unsure = solved(seed, WIDE_M)
    found, gone_m = asked(seed), (there - x)[:2]
    assert found.off_m == pytest.approx(there[:2] - TOLD_M, rel=1e-6, abs=1e-6)
    moment = np.outer(gone_m, gone_m) + unsure[:2, :2] - covariance[:2, :2]
    assert found.moment_m2 == pytest.approx(moment, rel=1e-6, abs=1e-6)


def test_a_place_that_fits_is_rarely_wrong() -> None:
    found = judged("a", 3, np.zeros(2), np.eye(2) * SIGMA_M**2 / 2.0, np.full(2, SIGMA_M))
    assert found.odds < RARELY
    assert doubts_of([found], {}) == {}


def test_doubt_is_shared_among_all_that_explains_as_much() -> None:
    alone = doubts_of([place("a", 5.0), place("b", -9.0)], {})
    shared = doubts_of([place("a", 5.0), place("b", 5.0)], {"c": 5.0})
    assert alone["a"].moment_m2 == pytest.approx(np.diag([4.0, 1.0]), rel=0.01)
    assert shared["a"].moment_m2 == pytest.approx(np.diag([4.0, 1.0]) / 3.0, rel=0.01)


@pytest.mark.parametrize(
    ("odds", "other", "delays", "off_m", "found"),
    [
        (20.0, 20.0 - CLEARER - 1.0, {}, 3.0, "a"),
        (20.0, 20.0 - CLEARER + 1.0, {}, 3.0, None),
        (physics.MODE_MARGIN - 1.0, -9.0, {}, 3.0, None),
        (20.0, -9.0, {"ff": 18.0}, 3.0, None),
        (20.0, -9.0, {"a": 18.0}, 3.0, "a"),
        (20.0, -9.0, {"a": 22.0}, 3.0, None),
        (20.0, -9.0, {}, 0.9 * LEAST_M, None),
    ],
)
def test_one_is_told_only_where_it_stands_out(
    odds: float, other: float, delays: dict[str, float], off_m: float, found: str | None
) -> None:
    best = mistold([place("a", odds, off_m), place("b", other)], delays)
    assert (None if best is None else best.name) == found


def test_nothing_is_told_where_nothing_was_asked() -> None:
    assert mistold([], {}) is None
    assert doubts_of([], {}) == {}
