"""What straight legs tell of a gyro's bias, and what ways that are not straight do not tell."""

import math
from collections.abc import Iterable

import numpy as np
import pytest

from estimator.fusion import physics
from estimator.fusion.learned.heading_line import Bias
from estimator.fusion.learned.straight_legs import StraightLegs

WALK_RAD2 = math.radians(0.3) ** 2
"""What the angle of a unit's frame gains in a second."""
CORNER = math.radians(90.0)


def walked(
    facings_rad: Iterable[float],
    legs: StraightLegs | None = None,
    since_t: float = 0.0,
    period_s: float = 1.0,
) -> tuple[StraightLegs, list[Bias]]:
    """Somebody walks at 1 m/s, as his unit reports it: which way it faces in each report.

    Returns:
        What his legs have told then, and the bias of each one, with all that it has told of it.
    """
    legs, told = legs or StraightLegs(), dict[int, list[Bias]]()
    for i, facing in enumerate(facings_rad):
        start = since_t + period_s * i
        moved = period_s * math.cos(facing), period_s * math.sin(facing)
        number = legs.number
        legs, bias = legs.walked(start, start + period_s, moved, WALK_RAD2 * period_s)
        if bias is not None:
            told.setdefault(number, []).append(bias)
    return legs, [together(each) for each in told.values()]


def together(told: Iterable[Bias]) -> Bias:
    """What several readings of one bias say of it."""
    known, products = np.array([(bias.sigma**-2, bias.value * bias.sigma**-2) for bias in told]).T
    return Bias(float(products.sum() / known.sum()), float(known.sum() ** -0.5))


def leg_of(rate_radps: float, seconds: int = 25, facing_rad: float = 0.0) -> list[float]:
    """Facings of a leg that turns, in the unit's frame."""
    return [facing_rad + rate_radps * second for second in range(seconds)]


def told_by(rates_radps: Iterable[float]) -> tuple[StraightLegs, list[Bias]]:
    """Legs one after the other, with a corner between them."""
    facings: list[float] = []
    for corner, rate in enumerate(rates_radps):
        facings += leg_of(rate, facing_rad=corner * CORNER)
    return walked([*facings, facings[-1] + CORNER])


def test_a_straight_leg_on_which_the_unit_turns_tells_its_bias() -> None:
    bias = math.radians(0.3)
    _, (told,) = told_by([-bias])
    assert told.value == pytest.approx(bias, rel=1e-6)


def test_what_a_leg_is_bent_by_makes_a_long_one_tell_more_than_a_short_one() -> None:
    _, (short,) = walked([*leg_of(0.0, 18), CORNER])
    _, (long,) = walked(leg_of(0.0, 34))
    # 8 s / L from end to end, of the turns of a circle's arc; a leg's last second may be half in a corner.
    for told, length_m in ((short, 17.0), (long, 32.0)):
        assert told.sigma > 8.0 * physics.SAGITTA_M / length_m**2
    assert long.sigma < 0.5 * short.sigma


def test_a_bias_is_as_far_off_as_it_says() -> None:
    chance, off = np.random.default_rng(3), []
    for _ in range(400):
        length = int(chance.integers(20, 31))
        bent = 8.0 * chance.normal(0.0, physics.SAGITTA_M) / length**2 * np.arange(length)
        walk = np.cumsum(chance.normal(0.0, math.sqrt(WALK_RAD2), length))
        noise = chance.normal(0.0, 0.04, length)
        _, told = walked([*(bent + walk + noise).tolist(), CORNER])
        off += [bias.value / bias.sigma for bias in told]
    assert len(off) > 350
    assert 0.85 < float(np.sqrt(np.mean(np.square(off)))) < 1.15


def test_nothing_of_a_corner_is_taken_for_bias() -> None:
    rounded = [math.radians(9.0), math.radians(45.0), math.radians(85.0)]
    _, told = walked([*leg_of(0.0), *rounded, *leg_of(0.0, facing_rad=CORNER), 2.0 * CORNER])
    assert [bias.value for bias in told] == pytest.approx([0.0, 0.0], abs=math.radians(0.05))


@pytest.mark.parametrize("seconds", [5, 10])
def test_a_short_leg_tells_nothing(seconds: int) -> None:
    legs, told = walked([*leg_of(0.01, seconds), CORNER])
    assert not told
    assert legs.number == 0


def test_who_walks_round_something_tells_nothing_of_his_gyro() -> None:
    legs, told = walked(leg_of(math.radians(1.3), 120))
    assert not told
    sigma = 0.003
    later = math.hypot(sigma, physics.STRAIGHT_SHARED_RADPS)
    assert legs.sigma_radps(sigma) > later, "and what he tells later counts for less"


def test_who_stops_ends_a_leg() -> None:
    legs, told = walked(leg_of(-0.002))
    for second in range(6):
        legs, bias = legs.walked(25.0 + second, 26.0 + second, (0.0, 0.0), 0.0)
        told += [] if bias is None else [bias]
    assert legs.number == 1
    assert together(told).value == pytest.approx(0.002)
    _, told = walked(leg_of(0.002, 10), legs, since_t=40.0)
    assert not told, "what comes after a halt is another leg"


def test_what_nobody_knows_the_way_of_ends_a_leg() -> None:
    legs, _ = walked(leg_of(-0.002))
    _, silent = legs.walked(31.0, 32.0, (1.0, 0.0), WALK_RAD2)
    _, long = legs.walked(25.0, 31.0, (6.0, 0.0), WALK_RAD2)
    assert silent is not None
    assert long is not None
    assert silent.value == long.value == pytest.approx(0.002)


@pytest.mark.parametrize("period_s", [0.1, 0.5, 2.0])
def test_how_often_a_unit_reports_makes_no_difference(period_s: float) -> None:
    facings = [-0.003 * period_s * i for i in range(round(28.0 / period_s))]
    _, (told,) = walked([*facings, *[facings[-1] + CORNER] * round(4.0 / period_s)], period_s=period_s)
    _, (each_second,) = walked([*leg_of(-0.003, 28), CORNER])
    assert told.value == pytest.approx(0.003, rel=0.01)
    assert told.sigma == pytest.approx(each_second.sigma, rel=0.35)


def test_however_many_legs_tell_a_bias_no_better_than_all_of_them_may_be_bent() -> None:
    legs, told = told_by([-0.004] * 40)
    information = sum(legs.sigma_radps(bias.sigma) ** -2 for bias in told)
    assert len(told) == 40
    # All errors v of their own and c in common: 1ᵀ (v I + c 1 1ᵀ)⁻¹ 1.
    variance = told[-1].sigma ** 2 * np.eye(40) + physics.STRAIGHT_SHARED_RADPS**2
    assert information == pytest.approx(float(np.linalg.inv(variance).sum()), rel=1e-3)
    assert information < physics.STRAIGHT_SHARED_RADPS**-2


def test_a_leg_that_tells_little_takes_nothing_from_one_that_tells_much() -> None:
    """Errors of their own and one in common: 1ᵀ (V + c 1 1ᵀ)⁻¹ 1, whatever each of them is."""
    legs, told = walked([*leg_of(-0.003, 28), *leg_of(-0.003, 18, CORNER), 2.0 * CORNER])
    variance = np.diag([bias.sigma**2 for bias in told]) + physics.STRAIGHT_SHARED_RADPS**2
    information = sum(legs.sigma_radps(bias.sigma) ** -2 for bias in told)
    assert len(told) == 2
    assert told[1].sigma > 1.5 * told[0].sigma
    assert information == pytest.approx(float(np.linalg.inv(variance).sum()), rel=0.02)


def test_a_leg_tells_while_it_is_under_way_what_it_has_not_told_yet() -> None:
    _, (half,) = walked(leg_of(-0.003, 18))
    legs, (whole,) = walked(leg_of(-0.003, 28))
    assert legs.number == 0, "he is still on it"
    _, (over,) = walked([*leg_of(-0.003, 28), CORNER])
    assert half.value == whole.value == over.value == pytest.approx(0.003)
    assert half.sigma > whole.sigma >= over.sigma
    shown = legs.leg.bias() if legs.leg is not None else None
    assert shown is not None
    assert over.sigma**-2 == pytest.approx(shown.sigma**-2, abs=physics.BIAS_SIGMA_MOST_RADPS**-2)


def test_what_seems_to_turn_faster_than_gyros_do_waits_until_the_leg_is_over() -> None:
    """As somebody does who goes round a tank, before that shows."""
    _, told = walked(leg_of(math.radians(0.6), 20))
    assert not told
    _, (waited,) = walked([*leg_of(math.radians(0.6), 20), 2.0 * CORNER])
    assert waited.value == pytest.approx(-math.radians(0.6))


def test_legs_that_differ_by_more_than_ways_are_bent_by_tell_less() -> None:
    alike, _ = told_by([0.004, 0.004, 0.004, 0.004])
    differ, _ = told_by([0.006, -0.006, 0.006, -0.006])
    assert alike.bent == 1.0
    assert differ.bent > 2.0
    assert differ.sigma_radps(0.003) > alike.sigma_radps(0.003)


def test_what_each_leg_is_worth_changes_only_where_one_has_told_more() -> None:
    facings = [*leg_of(0.004, 30), *leg_of(-0.006, 30, CORNER), *leg_of(0.0, 30)]
    legs, more = StraightLegs(), 0
    for second, facing in enumerate(facings):
        before = legs
        legs, _ = walked([facing], before, float(second))
        more += legs.has_told_more(before)
        assert legs.has_told_more(before) or legs.unsurer == before.unsurer
    assert 1 < more < len(facings) // 4
