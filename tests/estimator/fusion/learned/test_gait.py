"""Whether somebody crawls, by the pace that his unit tells."""

from collections.abc import Iterable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion import physics
from estimator.fusion.learned.gait import RENEWED, Gait

CRAWL_MPS, WALK_MPS = 0.4, 1.0


def gone(paces_mps: Iterable[float], begun: Gait | None = None) -> Gait:
    """How somebody goes after seconds at each pace."""
    gait = begun or Gait()
    for pace_mps in paces_mps:
        gait = gait.after(pace_mps, 1.0)
    return gait


def test_who_crawls_is_noticed_within_seconds_and_so_is_who_walks_again() -> None:
    crawls = gone([CRAWL_MPS] * 6)
    assert crawls.slow
    assert not gone([WALK_MPS] * 6, crawls).slow


def test_who_turns_round_or_takes_one_short_step_does_not_crawl() -> None:
    assert not gone([WALK_MPS] * 5 + [CRAWL_MPS] * 2).slow


@given(st.lists(st.floats(physics.CRAWLS_MPS, physics.WALKS_MPS - 0.01), max_size=30), st.booleans())
def test_a_pace_between_both_says_nothing_new(paces_mps: list[float], slow: bool) -> None:
    begun = Gait(physics.CRAWLS_MPS if slow else physics.WALKS_MPS, slow)
    assert gone(paces_mps, begun).slow == slow


@given(st.lists(st.floats(0.1, 3.0), min_size=1, max_size=10))
def test_a_pace_is_the_same_however_a_way_is_told(paces_mps: list[float]) -> None:
    """Half by half a second, and second by second."""
    halves = [pace_mps for pace_mps in paces_mps for _ in range(2)]
    by_halves = Gait()
    for pace_mps in halves:
        by_halves = by_halves.after(0.5 * pace_mps, 0.5)
    assert by_halves.pace_mps == pytest.approx(gone(paces_mps).pace_mps)


def test_what_a_crawl_is_off_by_is_another_scale_and_so_is_that_of_a_walk() -> None:
    crawls = gone([CRAWL_MPS] * 6)
    across_m2, *_, scale2 = crawls.doubt()
    assert scale2**0.5 == pytest.approx(physics.CRAWL_SCALE_SIGMA)
    assert 0.1 < across_m2**0.5 < 0.3
    assert gone([WALK_MPS] * 6, crawls).doubt()[-1] ** 0.5 == pytest.approx(physics.SCALE_SIGMA)


def test_no_random_walk_of_a_scale_is_taken_for_another_one() -> None:
    """Nor that of a day."""
    assert physics.SCALE_WALK_PER_ROOT_S**2 * 86_400.0 < RENEWED < physics.SCALE_SIGMA**2 / 10.0
