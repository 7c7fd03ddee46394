"""What a standstill tells of a gyro's bias."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion import physics
from estimator.fusion.learned.heading_line import Bias
from estimator.fusion.learned.zaru import Standing, stand_on
from estimator.fusion.memory.ledger import Ledger
from estimator.fusion.memory.state import FusionState
from estimator.fusion.tick import fold_tick
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node


def stood(headings_rad: list[float], period_s: float = 1.0) -> tuple[Standing, list[Bias]]:
    """A unit at rest reports headings; what is left unused, and the biases that it told meanwhile."""
    standing, told = None, []
    for i, heading in enumerate(headings_rad):
        standing, bias = stand_on(standing, 100.0 + period_s * i, heading)
        told += [] if bias is None else [bias]
    assert standing is not None
    return standing, told


@given(headings=st.lists(st.floats(-0.02, 0.02), min_size=6, max_size=29), start=st.floats(-10.0, 10.0))
def test_the_bias_is_the_slope_of_the_line_through_the_headings_whatever_way_they_face(
    headings: list[float], start: float
) -> None:
    reported = [math.remainder(start + heading, 2.0 * math.pi) for heading in headings]
    standing, told = stood(reported)
    bias = standing.bias()
    assert bias is not None
    assert not told
    slope = np.polyfit(np.arange(len(headings)), headings, 1)[0]
    assert bias.value == pytest.approx(-slope, abs=1e-9)


@pytest.mark.parametrize("seconds", [6, 12, 29])
def test_a_bias_is_as_far_off_as_it_says(seconds: int) -> None:
    chance = np.random.default_rng(seconds)
    truth, off = math.radians(0.2), []
    for _ in range(400):
        walk = np.cumsum(chance.normal(0.0, physics.GYRO_WALK_RAD_PER_ROOT_S, seconds))
        headings = walk - truth * np.arange(seconds) + chance.normal(0.0, 0.01, seconds)
        bias = stood(headings.tolist())[0].bias()
        if bias is not None:  # now and then noise looks like a turn
            off.append((bias.value - truth) / bias.sigma)
    assert len(off) > 380
    assert 0.85 < float(np.sqrt(np.mean(np.square(off)))) < 1.15


def test_half_a_minute_tells_ten_times_as_much_as_five_seconds() -> None:
    chance = np.random.default_rng(1)
    headings = chance.normal(0.0, 0.01, 31).tolist()
    short, long = stood(headings[:6])[0].bias(), stood(headings)[1]
    assert short is not None
    assert len(long) == 1
    assert long[0].sigma < 0.1 * short.sigma


def test_a_short_standstill_tells_nothing() -> None:
    assert stood([0.0] * (physics.STILL_READINGS - 1))[0].bias() is None
    assert stood([0.0] * 40, period_s=0.1)[0].bias() is None


def test_who_turns_round_begins_a_standstill_anew_and_nothing_of_the_turn_is_taken_for_bias() -> None:
    before, after = [-0.001 * i for i in range(10)], [1.5 - 0.001 * i for i in range(10)]
    standing, told = stood(before + after)
    assert [bias.value for bias in told] == pytest.approx([0.001])
    left = standing.bias()
    assert left is not None
    assert left.value == pytest.approx(0.001)


def test_a_unit_that_reports_seldom_tells_its_bias_as_well() -> None:
    _, told = stood([-0.008 * i for i in range(12)], period_s=8.0)
    assert [bias.value for bias in told] == pytest.approx([0.001, 0.001], rel=0.01)


def test_whoever_may_have_turned_in_a_silence_begins_a_standstill_anew() -> None:
    standing, bias = stand_on(stood([-0.001 * i for i in range(28)])[0], 200.0, 1.5)
    assert bias is not None
    assert bias.value == pytest.approx(0.001)
    assert standing.line.since_t == 200.0


def test_a_standstill_that_ends_tells_the_units_bias_when_its_bearer_walks_on() -> None:
    state = FusionState()
    state.ledger = Ledger(complete=True)
    place = (0.0, 0.0, 0.0)
    fold_tick(state, 0.5, [Node(t=0.0, node="ff1", role="responder", position_m=place, sigma_m=0.1)])
    beta = math.radians(0.2)
    for second in range(1, 21):
        step = (0.0, 0.0, 0.0) if second < 20 else (1.0, 0.0, 0.0)
        reading = Displacement(
            t=float(second), from_t=second - 1.0, node="ff1", delta_m=step, heading_rad=-beta * second
        )
        fold_tick(state, float(second), [reading])
        known = float(state.graph.value(state.nodes["ff1"].unit)[1])
        assert known == pytest.approx(beta if second == 20 else 0.0, rel=0.025, abs=1e-9)


@pytest.mark.parametrize("stood_s", [29, 33], ids=["told as he goes", "told before"])
def test_whoever_sets_off_is_biased_less_surely_than_he_was_at_rest(stood_s: int) -> None:
    state = FusionState()
    state.ledger = Ledger(complete=True)
    place = (0.0, 0.0, 0.0)
    fold_tick(state, 0.5, [Node(t=0.0, node="ff1", role="responder", position_m=place, sigma_m=0.1)])
    for second in range(1, stood_s + 2):
        step = (0.0, 0.0, 0.0) if second <= stood_s else (1.0, 0.0, 0.0)
        t = float(second)
        reading = Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=step, heading_rad=-0.001 * t)
        fold_tick(state, t, [reading])
    bias = state.graph.rows(state.nodes["ff1"].unit).start + 1
    sigma = math.sqrt(state.graph.covariance()[bias, bias])
    ((told_t, _, _, value, told_sigma, *_),) = state.ledger.table("singles")
    assert told_t <= stood_s, "what he turns as he goes is no bias"
    assert value == pytest.approx(0.001)
    assert told_sigma < 0.3 * physics.SET_OFF_BIAS_RADPS
    assert physics.SET_OFF_BIAS_RADPS <= sigma < 1.1 * physics.SET_OFF_BIAS_RADPS
