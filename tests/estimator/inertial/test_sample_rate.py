"""Units whose samples come faster or slower than their readings say."""

import numpy as np
import pytest

from estimator.inertial.sample_rate import REFUTED, RIGHT, SAID_AFTER_S, Clock, add_epoch

RATE_HZ = 100.0


def heard(
    pace: float, each: int, jitter_s: float = 0.0, lost: float = 0.0, cut: float = 0.0, seconds: float = 60.0
) -> Clock:
    """A clock by readings of so many samples, of which some get lost, and of some their beginning."""
    chance, clock, taken = np.random.default_rng(3), Clock.new(RATE_HZ), 0
    while taken * pace / RATE_HZ < seconds:
        count = each
        if chance.random() < cut:
            gone = int(chance.integers(1, 1 + each // 10))
            taken, count = taken + gone, each - gone
        t = 1.7e9 + taken * pace / RATE_HZ + chance.uniform(-jitter_s, jitter_s)
        taken += count
        if chance.random() >= lost:
            clock = add_epoch(clock, t, RATE_HZ, overlaps=False)
            clock = clock._replace(counted=clock.counted + count)
    return clock


@pytest.mark.parametrize("pace", [0.9, 0.96, 0.98, 1.02, 1.04, 1.1])
@pytest.mark.parametrize("each", [10, 100, 500])
@pytest.mark.parametrize("jitter_s", [0.0, 0.002, 0.02])
def test_the_pace_of_a_clock_is_learned_from_epochs(pace: float, each: int, jitter_s: float) -> None:
    clock = heard(pace, each, jitter_s)
    assert clock.pace == pytest.approx(pace, abs=0.002)
    assert abs(clock.pace - pace) < 3.0 * clock.sigma
    assert clock.sigma < 0.003
    assert clock.remark is not None
    assert float(clock.remark.split()[3]) == pytest.approx(RATE_HZ / pace, abs=0.3)


@pytest.mark.parametrize("pace", [0.96, 1.04])
@pytest.mark.parametrize(("lost", "cut"), [(0.05, 0.0), (0.2, 0.0), (0.0, 0.1)])
def test_lost_samples_do_not_change_it(pace: float, lost: float, cut: float) -> None:
    clock = heard(pace, 100, 0.005, lost, cut)
    assert clock.pace == pytest.approx(pace, abs=0.003)


@pytest.mark.parametrize("each", [10, 100, 500])
@pytest.mark.parametrize(
    ("jitter_s", "lost", "cut"), [(0.0, 0.0, 0.0), (0.02, 0.0, 0.0), (0.002, 0.1, 0.0), (0.002, 0.0, 0.1)]
)
def test_a_clock_that_is_right_is_left_alone(each: int, jitter_s: float, lost: float, cut: float) -> None:
    clock = heard(1.0, each, jitter_s, lost, cut)
    assert clock.pace == 1.0
    assert clock.sigma < 2.0 * RIGHT
    assert clock.remark is None


@pytest.mark.parametrize("late_s", [-0.02, 0.04, 0.15])
def test_a_single_reading_that_comes_late_or_early_tells_no_pace(late_s: float) -> None:
    clock = add_epoch(Clock.new(RATE_HZ), 0.0, RATE_HZ, overlaps=False)._replace(counted=200)
    clock = add_epoch(clock, 2.0 + late_s, RATE_HZ, overlaps=False)
    assert clock.pace == 1.0
    assert np.exp(clock.paces[0, 0]) > REFUTED


def test_what_overlaps_what_came_before_tells_no_pace() -> None:
    clock = add_epoch(Clock.new(RATE_HZ), 0.0, RATE_HZ, overlaps=False)
    for second in range(1, 30):
        # Each reading begins with the last tenth of a second of the one before.
        clock = add_epoch(clock._replace(counted=clock.counted + 100), second - 0.1, RATE_HZ, overlaps=True)
    assert clock.pace == 1.0


def test_a_clock_that_warms_is_followed() -> None:
    clock, t = Clock.new(RATE_HZ), 0.0
    for second in range(1200):
        clock = add_epoch(clock, t, RATE_HZ, overlaps=False)._replace(counted=100)
        pace = 1.04 - 0.01 * second / 1200
        t += pace
    assert clock.pace == pytest.approx(pace, abs=0.0005)


def test_another_rate_that_is_told_begins_anew() -> None:
    clock = add_epoch(heard(1.04, 100), 1.7e9 + 3600.0, 200.0, overlaps=False)
    assert (clock.pace, clock.rate_hz) == (1.0, 200.0)


def test_nothing_is_said_before_it_is_certain() -> None:
    assert heard(1.04, 100, seconds=0.8 * SAID_AFTER_S).remark is None
