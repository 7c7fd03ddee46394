"""Ways of units, but for what their heights rise by themselves."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fusion.memory.ledger import ASSUMED, UNSEEN, Ledger
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.levelled_ways import forget_steps, levelled, tell_rises

FF1 = NodeState(node="ff1", role="responder", index=0, mode="unit", t=0.0)
PACE_M, RISES = 0.7, 0.03


def steps(rises: float, seconds: int = 300, given: float = ASSUMED) -> Array:
    """A unit's rows of the ledger: to and fro on a floor."""
    found = np.zeros((seconds, 12))
    found[:, 0], found[:, 2] = np.arange(1.0, seconds + 1.0), np.arange(seconds)
    found[:, 3] = np.where(np.arange(seconds) // 28 % 2 == 0, PACE_M, -PACE_M)
    found[:, 5], found[:, 7], found[:, 11] = rises * PACE_M, 1e-3, given
    return found


def fused(rows: Array, complete: bool = False) -> FusionState:
    state = FusionState()
    state.ledger = Ledger(complete)
    state.nodes["ff1"] = FF1
    state.owners = ("ff1",)
    state.ledger.extend("steps", rows)
    return state


def test_a_unit_that_rises_goes_level_on_a_floor() -> None:
    assert abs(levelled(FF1, steps(RISES))[:, 5].sum()) < 0.3
    assert steps(RISES)[:, 5].sum() == pytest.approx(RISES * 300 * PACE_M)


def test_what_is_level_already_stays_what_it_is() -> None:
    """A unit that measures no heights, samples that have been levelled, and who goes on unseen."""
    flat, raw, unseen = steps(0.0), steps(RISES), steps(RISES, given=UNSEEN)
    assert levelled(FF1, flat) is flat
    assert levelled(replace(FF1, raw=True), raw) is raw
    np.testing.assert_array_equal(levelled(FF1, unseen), unseen)


def test_who_flies_climbs_as_he_says() -> None:
    rows = steps(RISES)
    assert levelled(replace(FF1, role="uav"), rows) is rows


def test_what_is_forgotten_has_told_how_a_unit_rises() -> None:
    state = fused(steps(RISES))
    forget_steps(state, 200.0)
    assert state.ledger.table("steps")[0, 0] == 200.0
    mean, variance = state.nodes["ff1"].rises_before
    assert mean == pytest.approx(RISES, abs=3e-3)
    assert variance < 1e-4
    forget_steps(state, 230.0)
    assert state.ledger.table("steps")[0, 0] == 200.0


def test_nothing_is_forgotten_where_the_whole_incident_is_to_be_solved() -> None:
    state = fused(steps(RISES), complete=True)
    forget_steps(state, 200.0)
    assert len(state.ledger.table("steps")) == 300
    assert state.nodes["ff1"].rises_before == FF1.rises_before


def test_the_filter_goes_on_with_what_legs_have_told() -> None:
    state = fused(steps(RISES))
    tell_rises(state, [0])
    assert state.nodes["ff1"].rises == pytest.approx(RISES, abs=3e-3)


def test_where_the_ground_may_climb_a_way_is_as_unsure_as_that() -> None:
    """Straight on, by 4 %: a hill's slope or the unit's."""
    straight = steps(0.04)
    straight[:, 3] = PACE_M
    unsure_m2 = [(levelled(FF1, rows)[:, 7] - rows[:, 7]).sum() for rows in (straight, steps(0.04))]
    assert unsure_m2[0] > 2.0**2
    assert unsure_m2[1] < 0.5**2
