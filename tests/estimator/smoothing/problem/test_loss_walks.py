"""What is known beforehand of what powers and ranges lose."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.losses import EVERYONE, parts_of
from estimator.smoothing.problem.loss_walks import LossWalks
from tests.estimator.smoothing.keyframes.test_losses import incident
from tests.estimator.smoothing.windows import difference, fused, problem_of


@pytest.fixture(scope="module")
def layout() -> Layout:
    return problem_of(fused(incident())).layout


@pytest.fixture(scope="module")
def ranged() -> Layout:
    return problem_of(fused(incident(ranged=True))).layout


def lost_to(layout: Layout, engine: float, everyone: float, kind: int = RSSI) -> Array:
    """An estimate in which a crew has lost so much to all radios from the first minute on, more to one."""
    x = layout.start()
    border = x[layout.length * layout.width :]
    vehicle = layout.state.nodes["engine"].index
    for (_, number), loss in layout.lost.items():
        if loss.kind == kind:
            border[loss.column] = -everyone - (engine if parts_of(number)[2] == vehicle else 0.0)
    return x


def cost(layout: Layout, engine: float, everyone: float, kind: int = RSSI) -> float:
    return LossWalks(layout, ()).cost(lost_to(layout, engine, everyone, kind))


def test_in_sight_nothing_is_lost_and_a_building_takes_more_easily_than_it_adds(layout: Layout) -> None:
    assert cost(layout, 0.0, 0.0) < cost(layout, 0.0, 14.0) < cost(layout, 0.0, -14.0)


def test_what_all_radios_lose_is_likelier_than_what_one_loses_beside_the_others(layout: Layout) -> None:
    assert cost(layout, 0.0, 14.0) < cost(layout, 14.0, 0.0)


def test_nothing_is_gained_however_often_it_is_heard(layout: Layout) -> None:
    """Else powers of one at a metre and a gain were as likely as powers that are told without any."""
    gains = [cost(layout, 0.0, -gained_db) for gained_db in (0.0, 4.0, 10.0, 20.0, 40.0)]
    assert gains == sorted(gains)
    assert gains[-1] - gains[-2] > 100.0
    assert cost(layout, 0.0, 40.0) - cost(layout, 0.0, 20.0) < 10.0


def test_what_was_lost_goes_on_being_lost(layout: Layout) -> None:
    """A shell between a crew and all radios costs once, not again each minute."""
    x = lost_to(layout, 0.0, 14.0)
    border = x[layout.length * layout.width :]
    late = max(loss.since_s for loss in layout.lost.values())
    for loss in layout.lost.values():
        border[loss.column] *= loss.since_s < late
    assert cost(layout, 0.0, 14.0) < LossWalks(layout, ()).cost(x)


def test_what_a_prior_tells_already_is_told_once(layout: Layout) -> None:
    keys = list(layout.lost)
    assert len(LossWalks(layout, keys).columns) == 0
    everything, rest = LossWalks(layout, ()).columns, LossWalks(layout, keys[:2]).columns
    assert len(everything) - len(rest) == len(everything) * 2 // len(keys)


def test_ranges_are_rarely_off_by_much_and_as_easily_too_short_as_too_long(ranged: Layout) -> None:
    """What all of them share may be an antenna delay."""
    for too_long_m in (0.1, 0.3, 1.0):
        alike = cost(ranged, 0.0, too_long_m, RANGE)
        assert alike == pytest.approx(cost(ranged, 0.0, -too_long_m, RANGE))
        assert cost(ranged, 0.0, 0.0, RANGE) < alike < cost(ranged, 0.0, 2.0 * too_long_m, RANGE)
        assert alike < cost(ranged, too_long_m, 0.0, RANGE)


def test_what_is_held_is_nil_and_what_is_not_is_what_it_was(ranged: Layout) -> None:
    held, free = LossWalks(ranged, (), (RANGE,)), LossWalks(ranged, ())
    powers, ranges = lost_to(ranged, 0.0, 14.0), lost_to(ranged, 0.0, 0.1, RANGE)
    nil = lost_to(ranged, 0.0, 0.0)
    assert held.cost(powers) - held.cost(nil) == pytest.approx(free.cost(powers) - free.cost(nil))
    assert held.cost(ranges) - held.cost(nil) > 1e3 > free.cost(ranges) - free.cost(nil)


@given(st.integers(0, 1000))
def test_they_pull_as_their_cost_falls(ranged: Layout, seed: int) -> None:
    layout = ranged
    walks, x = LossWalks(layout, ()), layout.start()
    own = np.arange(len(layout.lost)) + layout.length * layout.width + layout.border - len(layout.lost)
    usual = np.array([(-7.0, 8.0) if one.kind == RSSI else (-0.3, 0.3) for one in layout.lost.values()])
    x[own] = np.random.default_rng(seed).normal(*usual.T)

    def of(lost_db: Array) -> Array:
        there = x.copy()
        there[own] = lost_db
        return np.array([walks.cost(there)])

    pulls = walks.weighed(x)
    slope = np.zeros(len(x))
    for columns, signs, pull in zip(
        walks.columns, walks.jacobian, pulls.information * pulls.residual, strict=True
    ):
        slope[walks.size + columns[columns >= 0]] -= signs[columns >= 0] * pull
    assert difference(of, x[own])[0] == pytest.approx(slope[own], abs=1e-4)


def test_all_radios_are_one_beside_each(layout: Layout) -> None:
    commons = {key for key, loss in layout.lost.items() if loss.common is None}
    assert {parts_of(number)[2] for _, number in commons} == {EVERYONE}
    assert {loss.common for loss in layout.lost.values()} - {None} == commons
