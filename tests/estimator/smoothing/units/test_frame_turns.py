"""How much likelier powers are if a unit's frame has turned: looked at for all moments and angles at once."""

import math

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.smoothing.units.frame_turns import KICKED, TURNS_RAD, ToldWay, turn_gains
from estimator.smoothing.units.heard_powers import HEARD

ANCHORS_M = np.array([(-15.0, -15.0), (15.0, -15.0), (15.0, 15.0), (-15.0, 15.0)])
TURNED_S, SECONDS, SIGMA_DB, SIGMA_M, EXPONENT = 20.0, 60, 6.0, 1.0, 2.2
MOMENTS_S = np.arange(4.0, SECONDS, 8.0)
USUAL = np.array([[0.0, 10.0], [0.0, 0.4]])


def legs(turned_rad: float) -> Array:
    """Where he is each second, who goes east, north and west by his unit, its frame turned then (m)."""
    faces = np.repeat([0.0, 0.5, 1.0], 20) * math.pi + np.where(
        np.arange(SECONDS) < TURNED_S, 0.0, turned_rad
    )
    return np.vstack([np.zeros(2), np.cumsum(np.column_stack([np.cos(faces), np.sin(faces)]), axis=0)])


def power_db(places_m: Array, anchor_m: Array, exponent: float = EXPONENT) -> Array:
    squared_m2 = ((places_m - anchor_m) ** 2).sum(axis=1) + 0.3**2
    return np.asarray(-5.0 * exponent * np.log10(squared_m2))


def length_m(places_m: Array, anchor_m: Array) -> Array:
    return np.asarray(np.hypot(*(places_m - anchor_m).T))


def asked(
    turned_rad: float,
    kicked: bool = False,
    exponent: float = EXPONENT,
    begin_t: float = 0.0,
    ranged: bool = False,
) -> tuple[Array, Array]:
    """Gains, and moments, where a solution follows the unit; all radios tell of a turn, or one was kicked."""
    told_m, true_m = legs(0.0), legs(0.0 if kicked else turned_rad)
    t = np.arange(1.0, SECONDS + 1.0)
    heard = []
    for radio, at_m in enumerate(ANCHORS_M):
        there_m = at_m + np.where((t > TURNED_S) & kicked & (radio == 0), 20.0, 0.0)[:, None]
        off_db = power_db(true_m[1:], there_m) - power_db(told_m[1:], at_m, exponent)
        rows = np.zeros((SECONDS, HEARD))
        rows[:, 0], rows[:, 1:3], rows[:, 4:6], rows[:, 6] = t, told_m[1:], at_m, off_db
        rows[:, 7], rows[:, 8], rows[:, 9], rows[:, 10] = exponent, SIGMA_DB**2, radio, -np.inf
        if ranged:
            rows[:, 6] = length_m(true_m[1:], there_m) - length_m(told_m[1:], at_m)
            rows[:, 7], rows[:, 8] = 0.0, SIGMA_M**2
        heard.append(rows)
    step_m = np.diff(told_m, axis=0)
    moment_m = step_m * (t - 0.5 - begin_t)[:, None]
    sums = np.vstack([np.zeros(4), np.cumsum(np.hstack([step_m, moment_m]), axis=0)])
    at = MOMENTS_S.astype(int)
    moments = np.column_stack([MOMENTS_S, told_m[at], np.zeros((len(at), 3))])
    told = ToldWay(begin_t, np.tile(sums[1:], (4, 1)), moments, sums[at], np.zeros(len(at)))
    law = USUAL + np.array([[0.0, 0.0], [exponent - EXPONENT, 0.0]])
    return turn_gains(np.vstack(heard), told, 0.0, law), MOMENTS_S


@pytest.mark.parametrize("angle", [0, 3, 8])
def test_the_angle_and_the_moment_of_a_turn_are_the_likeliest(angle: int) -> None:
    gains, moments_s = asked(float(TURNS_RAD[angle]))
    moment, by = np.unravel_index(gains.argmax(), gains.shape)
    assert abs(moments_s[moment] - TURNED_S) <= 8.0
    assert by == angle
    assert gains.max() > 10.0


@pytest.mark.parametrize("angle", [0, 3, 8])
def test_ranges_tell_of_a_turn_as_powers_do_and_more_clearly(angle: int) -> None:
    gains, moments_s = asked(float(TURNS_RAD[angle]), ranged=True)
    moment, by = np.unravel_index(gains.argmax(), gains.shape)
    assert abs(moments_s[moment] - TURNED_S) <= 8.0
    assert by == angle
    assert gains.max() > asked(float(TURNS_RAD[angle]))[0].max()


def test_ranges_of_a_radio_that_was_kicked_speak_for_a_turn_by_no_more_than_powers() -> None:
    assert asked(0.0, kicked=True, ranged=True)[0].max() < KICKED


def test_nothing_speaks_for_a_turn_where_all_was_heard_as_foretold() -> None:
    assert asked(0.0)[0].max() <= 0.0


def test_a_radio_that_was_kicked_speaks_for_a_turn_by_no_more_than_a_kick_is_rare() -> None:
    assert asked(0.0, kicked=True)[0].max() < KICKED


def test_a_law_that_a_wrong_way_has_made_flat_hides_no_turn() -> None:
    gains, moments_s = asked(float(TURNS_RAD[3]), exponent=1.2)
    moment, by = np.unravel_index(gains.argmax(), gains.shape)
    assert moments_s[moment] == TURNED_S
    assert by == 3
    assert gains.max() > 10.0


def test_who_heard_nobody_on_his_own_storey_has_not_turned() -> None:
    told = ToldWay(0.0, np.zeros((0, 4)), np.zeros((2, 6)), np.zeros((2, 4)), np.ones(2))
    assert turn_gains(np.zeros((0, HEARD)), told, 1.0, USUAL).max() <= 0.0
