"""What a jump of a link's ranges tells, that nobody can have walked."""

from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion.learned.link_correlation import ECHO_M, NEW, T, follow
from estimator.fusion.motion.recent_places import DECIDED, OUTSIDE, STATES, TrailEnd
from estimator.fusion.physics import ECHO_LOWER_S, ECHO_UNHEARD_S, ECHOES, FLIES_MPS, RANGE_NOISE, RUNS_MPS
from estimator.fusion.readings.echoes import SIGMAS, farthest_m, fit, hear, noise, tell
from estimator.graph.dense import Array

STEP_S, MOST_M = 0.2, 1.5


def heard(
    *values_m: float, step_s: float = STEP_S, walked_m: float = 0.1, link: Array | None = None
) -> Array:
    """What each of a link's ranges is told to be too long by (m)."""
    link = np.array(NEW) if link is None else link

    def told() -> Iterator[float]:
        for i, value_m in enumerate(values_m):
            waited_s = i * step_s - link[T]
            follow(link, i * step_s, i * walked_m)
            yield hear(link, waited_s, value_m, MOST_M)

    return np.array(list(told()))


def test_what_is_too_long_at_once_is_an_echo_until_it_is_as_short_again() -> None:
    found = heard(10.0, 10.1, 16.1, 16.2, 16.0, 10.2, 10.1)
    assert found == pytest.approx([0.0, 0.0, 6.0, 6.0, 6.0, 0.0, 0.0])


def test_who_walks_towards_the_radio_meanwhile_comes_back_by_more_and_who_leaves_by_less() -> None:
    for walked_m in (-2.0, 2.0):
        meanwhile = np.linspace(16.0, 16.0 + walked_m, 10)
        found = heard(10.0, *meanwhile, 10.0 + walked_m, 10.0 + walked_m)
        assert (found[1:11] == 6.0).all()
        assert (found[11:] == 0.0).all()


WALKED_M = MOST_M - 1e-9
"""By so much sums of floats are off at most."""


@given(st.lists(st.floats(-WALKED_M, WALKED_M), max_size=30))
def test_nothing_that_can_be_walked_is_an_echo(steps_m: list[float]) -> None:
    assert not heard(*np.cumsum([20.0, *steps_m])).any()


def test_an_echo_that_changes_by_less_than_half_goes_on() -> None:
    assert heard(10.0, 16.0, 18.0, 16.0, 10.0)[1:] == pytest.approx([6.0, 8.0, 6.0, 0.0])


def test_a_reading_far_too_short_does_not_make_an_echo_of_those_after_it() -> None:
    assert not heard(20.0, 20.0, 8.0, 8.0, 20.0, 20.0).any()


def test_a_link_that_began_with_an_echo_is_believed_once_it_stays_shorter() -> None:
    """That it was an echo before is told too late; that it is one again is told at once."""
    shorter = [10.0] * round(1.0 + 1.2 * ECHO_LOWER_S / STEP_S)
    assert heard(16.0, 16.0, *shorter, 16.0)[-1] == pytest.approx(6.0)
    assert heard(16.0, 16.0, *shorter[:5], 16.0)[-1] == 0.0


def test_after_a_pause_a_jump_tells_nothing() -> None:
    assert not heard(10.0, 30.0, step_s=1.1 * ECHO_UNHEARD_S).any()
    assert heard(10.0, 30.0, step_s=0.9 * ECHO_UNHEARD_S).any()


def test_an_echo_is_forgotten_over_some_rooms_walked_unless_its_ranges_misfit() -> None:
    ranges_m = [10.0, *[16.0] * 60]
    assert heard(*ranges_m, walked_m=0.1)[-1] > 0.0
    assert heard(*ranges_m, walked_m=1.0)[-1] == 0.0
    assert heard(*ranges_m, walked_m=1e6)[-1] == 0.0
    link = np.array(NEW)
    for i, value_m in enumerate(ranges_m):
        waited_s = i * STEP_S - link[T]
        follow(link, i * STEP_S, float(i))
        hear(link, waited_s, value_m, MOST_M)
        fit(link, 1e-6)
    assert link[ECHO_M] > 0.0


def test_an_echo_whose_end_was_not_heard_ends_when_its_ranges_fit_again() -> None:
    link = np.array(NEW)
    heard(10.0, 16.0, link=link)
    fits = 0
    while link[ECHO_M] > 0.0:
        fit(link, 0.5)
        fits += 1
    assert 3 < fits < 20


def end(moves: bool, decided: bool = True, outside: bool = False) -> Array:
    found = np.zeros(len(TrailEnd._fields))
    found[STATES], found[DECIDED], found[OUTSIDE] = 3.0 if moves else -1.0, decided, outside
    return found


def test_a_range_changes_by_noise_and_by_what_its_ends_run_or_fly() -> None:
    stands, walks, flies = end(moves=False), end(moves=True), end(moves=True, outside=True)
    still_m = SIGMAS * 0.1
    assert farthest_m(stands, stands, 2.0, 0.1) == pytest.approx(still_m)
    assert farthest_m(walks, stands, 2.0, 0.1) == pytest.approx(still_m + 2.0 * RUNS_MPS)
    assert farthest_m(walks, flies, 2.0, 0.1) == pytest.approx(still_m + 2.0 * (RUNS_MPS + FLIES_MPS))
    assert farthest_m(end(moves=False, decided=False), stands, 2.0, 0.1) > still_m + 2.0


def test_a_minute_of_one_echo_tells_hardly_more_than_one_reading_of_it() -> None:
    spread = np.array([noise(6.0, float(alike))[2] for alike in range(1, 300)])
    assert (1.0 / spread**2).sum() < 7.0 / RANGE_NOISE.spread**2


def test_only_echoes_get_the_noise_of_one() -> None:
    noises = np.tile(np.array(RANGE_NOISE), (3, 1))
    tell(noises, np.array([0.0, 6.0]), np.array([5.0, 4.0]))
    assert noises[[0, 2]].tolist() == [list(RANGE_NOISE)] * 2
    assert noises[1].tolist() == [ECHOES, 6.0, 2.0 * RANGE_NOISE.spread]
