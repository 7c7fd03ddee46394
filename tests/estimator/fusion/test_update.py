"""What a tick's readings tell of the noise."""

import numpy as np
import pytest

from estimator.fusion.learned.link_correlation import DRIFTS, ECHO_M, ECHO_ODDS, ERROR, KEPT, NEW
from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.fusion.physics import ECHOES
from estimator.fusion.rows.gauss_newton import GOOD, INDEFINITE, RESIDUAL, SOLVED, UNSOLVABLE, Minimum
from estimator.fusion.rows.rival_kernels import units_from
from estimator.fusion.rows.rows import (
    EXTRA,
    FIELDS,
    KIND,
    LINK,
    NOMINAL,
    ONE,
    OUTLIERS,
    SIGMA,
    SOURCE,
    VALUE,
    A,
    B,
)
from estimator.fusion.update import ask_and_take_in, outlier_again, tally
from estimator.graph.dense import Array
from estimator.graph.kirchhoff import Kirchhoff
from estimator.graph.variable import Variable

POWER_DBM, EXPONENT = -40.0, 2.0
X = np.array([POWER_DBM, EXPONENT])
"""A state of one radio law."""


def found(residual: Array, predicted: Array, good: Array) -> Minimum:
    """What readings have led to."""
    none = np.zeros(len(residual))
    return Minimum(SOLVED, X, X, np.zeros((len(none), 8)), none, residual, predicted, good, False)


def test_good_readings_are_summed_by_technology_and_follow_one_another_on_their_link() -> None:
    """Two on one link whose ends stand still, one on a link without an error, one of no technology."""
    table = np.zeros((4, FIELDS))
    table[:, KIND] = RANGE
    table[:, SOURCE], table[:, LINK] = [1, 1, 0, -1], [0, 0, 1, -1]
    table[:, NOMINAL], table[:, SIGMA] = 0.5, 0.4
    residual, predicted, good = (
        np.array([0.3, -0.2, 1.0, 9.0]),
        np.full(4, 0.04),
        np.array([0.9, 0.8, 0.2, 1.0]),
    )
    links, sums = np.tile(NEW, (2, 1)), np.zeros((3, 6))
    links[:, KEPT], links[:, ERROR] = 1.0, [1.5, np.nan]
    tally(table, found(residual, predicted, good), X, links, sums)
    unsure = 0.04 * 0.16 / 0.2
    first, second = 0.3 / 0.5, -0.2 / 0.5
    squares = 0.9 * (0.3**2 + unsure) / 0.25 + 0.8 * (0.2**2 + unsure) / 0.25
    products = 0.9 * (first * 1.5 - unsure / 0.25) + 0.8 * (second * first - unsure / 0.25)
    assert sums[1] == pytest.approx([1.7, squares, 1.7, products, 2.0, 0.0])
    assert sums[0] == pytest.approx([0.2, 0.2 * (1.0 + unsure) / 0.25, 0.0, 0.0, 1.0, 0.0])
    assert (sums[2] == 0.0).all()
    assert links[0, ERROR] == pytest.approx(second)
    assert np.isnan(links[1, ERROR])


def test_powers_of_who_has_no_unit_share_what_their_errors_say_and_all_others_less() -> None:
    """Each is off by as much as the one before it on its link, and of no estimate is anybody sure."""
    table, links, sums = np.zeros((4, FIELDS)), np.tile(NEW, (4, 1)), np.zeros((4, 6))
    table[:, KIND], table[:, SOURCE], table[:, LINK] = [RSSI, RANGE, RSSI, RANGE], range(4), range(4)
    table[:, EXTRA], table[:, NOMINAL], table[:, SIGMA] = -1, 2.0, 2.0
    links[:, KEPT], links[:, ERROR], links[:2, DRIFTS] = 1.0, 0.5, 1.0
    tally(table, found(np.ones(4), np.full(4, 4.0), np.ones(4)), X, links, sums)
    assert sums[:, 3] == pytest.approx([0.25, -0.25, -0.25, -0.25])


def test_who_rest_side_by_side_tell_nothing_of_the_noise_of_radios_farther_apart() -> None:
    """Of two powers the first is that of a radio a metre away, the second that of one at ten metres."""
    table, links, sums = np.zeros((2, FIELDS)), np.tile(NEW, (2, 1)), np.zeros((1, 6))
    table[:, KIND], table[:, SOURCE], table[:, LINK], table[:, EXTRA] = RSSI, 0, [0, 1], 0
    table[:, NOMINAL], table[:, SIGMA] = 6.0, 6.0
    expected_dbm, residual = np.array([POWER_DBM, POWER_DBM - 10.0 * EXPONENT]), np.array([0.5, 9.0])
    table[:, VALUE] = expected_dbm + residual
    tally(table, found(residual, np.zeros(2), np.ones(2)), X, links, sums)
    assert sums[0] == pytest.approx([1.0, (9.0 / 6.0) ** 2, 0.0, 0.0, 1.0, 1.0])
    assert np.isnan(links[0, ERROR])
    assert links[1, ERROR] == pytest.approx(9.0 / 6.0)


def test_only_a_reading_of_an_echo_tells_by_fitting_that_the_echo_has_ended() -> None:
    table, links = np.zeros((1, FIELDS)), np.array([NEW])
    table[:, SOURCE], table[:, NOMINAL], table[:, SIGMA] = 0, 0.3, 0.1
    links[0, ECHO_M], links[0, ECHO_ODDS] = 6.0, 0.1
    fits = np.zeros(1), np.zeros(1), np.full(1, 0.9)
    table[0, OUTLIERS] = 0.1
    tally(table, found(*fits), X, links, np.zeros((1, 6)))
    assert links[0, ECHO_M] == 6.0
    table[0, OUTLIERS] = ECHOES
    tally(table, found(*fits), X, links, np.zeros((1, 6)))
    assert links[0, ECHO_M] == 0.0


@pytest.mark.parametrize(
    ("kept", "error", "again"),
    [
        pytest.param(0.6, np.nan, True, id="the one before was one as well"),
        pytest.param(0.6, 0.5, False, id="the one before was good"),
        pytest.param(0.0, np.nan, False, id="there was none before"),
    ],
)
def test_an_outlier_is_told_from_two_in_a_row_on_one_link(kept: float, error: float, again: bool) -> None:
    """The first may be chance; the second may be a breadcrumb that was kicked."""
    table, links = np.zeros((2, FIELDS)), np.array([NEW])
    table[:, LINK] = -1, 0
    links[0, KEPT], links[0, ERROR] = kept, error
    bad, good = np.array([0.1, 0.1]), np.array([0.9, 0.9])
    assert outlier_again(table, bad, links, doubted=False) == again
    assert outlier_again(table, bad, links, doubted=True)
    assert not outlier_again(table, good, links, doubted=True)
    assert not outlier_again(table[:0], good[:0], links, doubted=True)


def unit(information: float = 4.0) -> Kirchhoff:
    """A unit whose heading, bias and scale are known by so much each."""
    graph = Kirchhoff()
    graph.add_node(Variable("unit", "ff"), (0.0, 0.0, 0.0), (information**-0.5,) * 3)
    return graph


def held(graph: Kirchhoff, heading_rad: float) -> tuple[tuple[int, float, bool, int], Array]:
    """A heading of ff that is told as surely as it is known, taken in; what comes of it."""
    table, told = np.zeros((1, FIELDS)), np.empty((1, 3))
    table[0, [B, EXTRA, SOURCE, LINK]] = -1.0
    table[0, KIND], table[0, A], table[0, VALUE] = ONE, 0, heading_rad
    table[0, SIGMA], table[0, NOMINAL], table[0, OUTLIERS] = 0.5, 0.5, 0.0
    newest, sums = np.array([NEW]), np.zeros((1, 6))
    changed, base_m, epochs, nobody = graph.turning(), np.zeros(2), np.zeros(1), units_from([], [])
    found, _ = ask_and_take_in(
        table, epochs, nobody, *graph.storage(), graph.size, changed, base_m, newest, told, sums, 6
    )
    return found, told


def test_a_state_rests_where_its_readings_have_led_it() -> None:
    """Known and told alike, the heading goes half the way; nothing is left to be solved."""
    graph = unit()
    (outcome, turned_rad, again, outliers), told = held(graph, -0.2)
    assert (outcome, again, outliers) == (SOLVED, False, 0)
    assert turned_rad == pytest.approx(0.1)
    assert graph.reference == pytest.approx([-0.1, 0.0, 0.0])
    assert graph.information == pytest.approx(np.diag([8.0, 4.0, 4.0]))
    assert (graph.vector == 0.0).all()
    assert told[0, [RESIDUAL, GOOD]] == pytest.approx([-0.1, 1.0])


def test_a_state_stays_as_it_was_where_readings_cannot_be_solved() -> None:
    graph = unit()
    before = graph.copy()
    assert held(graph, np.nan)[0][0] == UNSOLVABLE
    assert (graph.information == before.information).all()
    assert (graph.reference == before.reference).all()
    graph.storage()[0][0, 0] = -1.0
    assert held(graph, 0.2)[0][0] == INDEFINITE
    assert (graph.reference == before.reference).all()
