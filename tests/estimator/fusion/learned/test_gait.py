"""Whether somebody crawls, by the pace that his unit tells."""

import math
from collections.abc import Iterable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion import physics
from estimator.fusion.learned.gait import KEPT, RENEWED, Gait, kept

CRAWL_MPS, WALK_MPS = 0.4, 1.0
PART_S = 0.125
STRIDE = (0.0, 0.0, 0.2, 1.8, 2.0, 2.0, 1.8, 0.2)
"""How fast a boot is in the parts of a stride of a second, over the pace of its bearer."""


def gone(paces_mps: Iterable[float], begun: Gait | None = None) -> Gait:
    """How somebody goes after seconds at each pace."""
    gait = begun or Gait()
    for pace_mps in paces_mps:
        gait = gait.after(pace_mps, 1.0)
    return gait


WALKS, CRAWLS = gone([WALK_MPS] * 20), gone([CRAWL_MPS] * 20)


def changes(paces_mps: Iterable[float], begun: Gait) -> int:
    """How often somebody begins to go otherwise, in seconds at each pace."""
    times, gait = 0, begun
    for pace_mps in paces_mps:
        before, gait = gait, gait.after(pace_mps, 1.0)
        times += gait.changes(before)
    return times


def test_who_crawls_is_noticed_within_seconds_and_so_is_who_walks_again() -> None:
    assert changes([CRAWL_MPS] * 10, WALKS) == 1
    assert changes([CRAWL_MPS] * 10 + [WALK_MPS] * 10, WALKS) == 2


def test_who_turns_round_or_takes_some_short_steps_does_not_crawl() -> None:
    assert changes([CRAWL_MPS] * 5 + [WALK_MPS] * 5, WALKS) == 0


@given(st.lists(st.floats(0.2, physics.WALKS_MPS - 0.01), max_size=200))
def test_who_is_always_slow_goes_as_he_does_once(paces_mps: list[float]) -> None:
    """After 20 s at 0.4 m/s he is not taken for who begins to crawl again, whatever slow pace is his."""
    assert changes(paces_mps, CRAWLS) == 0


def test_who_crawls_from_the_first_on_is_noticed_once_and_who_walks_is_never() -> None:
    assert changes([CRAWL_MPS] * 60, Gait()) == 1
    assert changes([WALK_MPS] * 60, Gait()) == 0


def test_how_somebody_goes_is_not_known_by_his_first_step() -> None:
    assert gone([CRAWL_MPS]).slow is False
    assert gone([CRAWL_MPS] * 10).slow
    assert gone([WALK_MPS] * 10).slow is False


@given(st.lists(st.floats(physics.CRAWLS_MPS, physics.WALKS_MPS - 0.01), max_size=30), st.booleans())
def test_a_pace_between_both_says_nothing_new(paces_mps: list[float], slow: bool) -> None:
    assert changes(paces_mps, CRAWLS if slow else WALKS) == 0


@given(st.lists(st.floats(physics.CRAWLS_MPS, physics.WALKS_MPS - 0.01), min_size=20, max_size=60))
def test_who_has_not_walked_since_he_set_out_may_crawl(paces_mps: list[float]) -> None:
    assert gone(paces_mps).slow
    assert changes(paces_mps, Gait()) == 1
    assert changes([WALK_MPS] * 10, gone(paces_mps)) == 1


@given(st.lists(st.floats(0.2, 3.0), min_size=1, max_size=10))
def test_a_pace_is_the_same_however_a_way_is_told(paces_mps: list[float]) -> None:
    """Half by half a second, and second by second; at an even pace it is that pace from the first on."""
    halves = [pace_mps for pace_mps in paces_mps for _ in range(2)]
    by_halves = Gait()
    for pace_mps in halves:
        by_halves = by_halves.after(0.5 * pace_mps, 0.5)
    assert by_halves.pace_mps == pytest.approx(gone(paces_mps).pace_mps)
    assert gone([paces_mps[0]] * 3).pace_mps == pytest.approx(paces_mps[0])


@given(st.lists(st.floats(1e-300, 60.0), min_size=1, max_size=20), st.floats(0.2, 3.0))
def test_an_even_pace_is_that_pace_however_short_its_displacements_are(
    spans_s: list[float], pace_mps: float
) -> None:
    gait = Gait()
    for span_s in [*spans_s, 1.0]:
        gait = gait.after(pace_mps * span_s, span_s)
    assert gait.pace_mps == pytest.approx(pace_mps)


def test_the_shortest_time_that_can_be_told_tells_no_pace() -> None:
    gait = Gait().after(math.ulp(0.0), math.ulp(0.0))
    assert gait.told == 0.0
    assert gait.after(WALK_MPS, 1.0).pace_mps == pytest.approx(WALK_MPS)


@pytest.mark.parametrize("pace_mps", [CRAWL_MPS, WALK_MPS])
def test_a_boot_that_tells_parts_of_a_stride_tells_the_pace_of_its_bearer(pace_mps: float) -> None:
    """It stands for half of the time, and that is no standstill of his."""
    gait = Gait()
    for _ in range(20):
        for part in STRIDE:
            gait = gait.after(part * pace_mps * PART_S, PART_S)
    assert gait.pace_mps == pytest.approx(pace_mps)
    assert gait.slow == (pace_mps == CRAWL_MPS)


@given(st.lists(st.floats(0.9, 1.1), min_size=8, max_size=8))
def test_what_rolls_evenly_does_not_crawl(parts: list[float]) -> None:
    """A slow robot's wheels tell of its way what they tell of any."""
    gait = Gait()
    for _ in range(20):
        for part in parts:
            gait = gait.after(part * CRAWL_MPS * PART_S, PART_S)
    assert not gait.slow


@given(st.floats(0.0, 0.1), st.integers(1, 20))
def test_who_stands_goes_as_he_did(shuffled_m: float, seconds: int) -> None:
    for gait in (WALKS, CRAWLS):
        assert gone([shuffled_m] * seconds, gait) == gait


def test_what_a_crawl_is_off_by_is_another_scale_and_so_is_that_of_a_walk() -> None:
    assert CRAWLS.scale2**0.5 == pytest.approx(physics.CRAWL_SCALE_SIGMA)
    assert gone([WALK_MPS] * 20, CRAWLS).scale2 ** 0.5 == pytest.approx(physics.SCALE_SIGMA)
    assert kept(CRAWLS.scale2) == kept(WALKS.scale2) == KEPT


def test_no_random_walk_of_a_scale_is_taken_for_another_one() -> None:
    """Nor that of a day."""
    assert kept(physics.SCALE_WALK_PER_ROOT_S**2 * 86_400.0) == 1.0
    assert physics.SCALE_WALK_PER_ROOT_S**2 * 86_400.0 < RENEWED < physics.SCALE_SIGMA**2 / 10.0
