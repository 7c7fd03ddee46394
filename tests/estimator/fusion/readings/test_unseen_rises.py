"""A jump is shared between a height and what an altimeter is off by, each as far as it is likely."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion.learned.altimeter_zero import AltimeterZero
from estimator.fusion.learned.unseen_rise import Rise
from estimator.fusion.memory.state import FusionState
from estimator.fusion.readings.unseen_rises import are_together, goes_back, has_stood, share_jump
from estimator.graph.variable import Variable
from estimator.measurements import AnyReading
from estimator.measurements.altitude import Altitude
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from tests.estimator.smoothing.windows import fused

SINCE_T, NOW_T, CREW = 25.0, 29.0, ("ff1", "ff2")


def inside(walks: bool = False) -> FusionState:
    """Two of a crew, the first one with an altimeter; both stand, or he walks."""
    told: list[AnyReading] = [
        Node(t=0.0, node=n, role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.01) for n in CREW
    ]
    for second in range(1, int(NOW_T) + 1):
        t, pace_m = float(second), 1.0 if walks else 0.0
        told.append(Altitude(t=t, node="ff1", up_m=0.01, sigma_m=0.1))
        told.append(Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(pace_m, 0.0, 0.001)))
        told.append(Displacement(t=t, from_t=t - 1.0, node="ff2", delta_m=(0.0, 0.0, 0.001)))
    return fused(told)


def zeroed(state: FusionState) -> AltimeterZero:
    return state.nodes["ff1"].absolute.zeroed


@given(st.floats(0.05, 0.95), st.floats(2.5, 30.0))
def test_once_read_it_has_the_moments_of_a_jump_of_either(p: float, jump_m: float) -> None:
    """j with probability p, else nil: mean p j, variance p (1 − p) j²."""
    state = INSIDE.copy()
    node = state.nodes["ff1"]
    before = state.graph.covariance()
    up = state.graph.starts[node.position] + 2
    share_jump(state, node, Rise(SINCE_T, NOW_T, jump_m, zeroed(state).name or ""), p)
    known = state.altimeters[zeroed(state).name or ""]
    height_m2 = state.graph.covariance()[up, up] - before[up, up]
    off_m2 = known[1] ** 2
    read_m2 = height_m2 + off_m2
    assert jump_m * height_m2 / read_m2 == pytest.approx(p * jump_m, rel=0.05)
    assert height_m2 * off_m2 / read_m2 == pytest.approx(p * (1.0 - p) * jump_m**2, rel=0.05)


def test_what_it_has_read_since_then_another_altimeter_has() -> None:
    state = INSIDE.copy()
    was = zeroed(state).name or ""
    share_jump(state, state.nodes["ff1"], Rise(SINCE_T, NOW_T, 3.0, was), 0.5)
    singles = state.ledger.table("singles")
    since = singles[:, 0] >= SINCE_T
    assert (singles[since, 6] == state.source(zeroed(state).name or "")).all()
    assert (singles[~since, 6] == state.source(was)).all()


def test_his_steps_while_it_jumped_may_have_led_up_and_no_others() -> None:
    state = INSIDE.copy()
    node, before = state.nodes["ff1"], INSIDE.ledger.table("steps")
    share_jump(state, node, Rise(SINCE_T, NOW_T, 3.0, zeroed(state).name or ""), 0.5)
    more_m2 = state.ledger.table("steps")[:, 7] - before[:, 7]
    mine = (before[:, 1] == node.index) & (before[:, 0] == SINCE_T)
    assert more_m2[mine].sum() == pytest.approx(0.5 * 3.0**2)
    assert not more_m2[~mine].any()


def test_one_that_has_not_moved_at_all_is_off_by_anything() -> None:
    state = INSIDE.copy()
    share_jump(state, state.nodes["ff1"], Rise(SINCE_T, NOW_T, 3.0, zeroed(state).name or ""), 0.0)
    off_m, sigma_m = state.altimeters[zeroed(state).name or ""]
    assert (off_m, sigma_m) == (0.0, 8.0)
    assert np.array_equal(state.ledger.table("steps"), INSIDE.ledger.table("steps"))


def test_a_jump_that_is_undone_leads_back_to_the_altimeter_that_it_was() -> None:
    state = INSIDE.copy()
    was = zeroed(state).name or ""
    assert not goes_back(state, state.nodes["ff1"], NOW_T, 3.0)
    share_jump(state, state.nodes["ff1"], Rise(SINCE_T, NOW_T, -3.0, was), 0.5)
    assert not goes_back(state, state.nodes["ff1"], NOW_T, -3.0)
    assert goes_back(state, state.nodes["ff1"], NOW_T, 3.0)
    assert zeroed(state).name == was
    assert zeroed(state).rise == Rise()
    assert Variable("altimeter", was) in state.graph


def test_who_walks_has_not_stood_and_is_soon_elsewhere() -> None:
    walking = inside(walks=True)
    assert has_stood(INSIDE, INSIDE.nodes["ff1"], SINCE_T)
    assert not has_stood(walking, walking.nodes["ff1"], SINCE_T)
    assert has_stood(walking, walking.nodes["ff2"], SINCE_T)
    assert are_together(INSIDE, INSIDE.nodes["ff1"], INSIDE.nodes["ff2"])
    assert not are_together(walking, walking.nodes["ff1"], walking.nodes["ff2"])


def test_who_was_silent_meanwhile_has_stood_if_he_got_nowhere() -> None:
    """Lifts are of steel."""
    for pace_m, stands in ((0.0, True), (1.0, False)):
        told: list[AnyReading] = [
            Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.01)
        ]
        told += [step(t, t - 1.0, 1.0) for t in (1.0, 2.0, 3.0)]
        told += [step(13.0, 3.0, 10.0 * pace_m), *(step(t, t - 1.0, 1.0) for t in (14.0, 15.0, 16.0, 17.0))]
        state = fused(told)
        assert has_stood(state, state.nodes["ff1"], 13.0) == stands


def step(t: float, from_t: float, east_m: float) -> Displacement:
    return Displacement(t=t, from_t=from_t, node="ff1", delta_m=(east_m, 0.0, 0.001))


INSIDE = inside()
