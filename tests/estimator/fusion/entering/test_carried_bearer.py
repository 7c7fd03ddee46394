"""What a unit that stands tells while its bearer is carried."""

import pytest

from estimator.fusion.entering.carried_bearer import let_be_carried
from estimator.fusion.entering.unbelieved_steps import leave_behind
from estimator.fusion.memory.ledger import GIVEN, UNSEEN
from estimator.fusion.memory.state import FusionState
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.rssi import Rssi
from tests.estimator.smoothing.windows import entered, fused

STOOD_S, NOW_S = 5, 15


def tells(second: int, east_m: float = 0.0, from_t: float | None = None) -> Displacement:
    return Displacement(t=float(second), from_t=from_t, node="ff1", delta_m=(east_m, 0.0, 0.0))


def carried() -> FusionState:
    """He has walked, and is carried since."""
    readings: list[AnyReading] = [entered(node="ff1")]
    for second in range(1, NOW_S + 1):
        readings.append(tells(second, 0.0 if second > STOOD_S else 1.0, second - 1.0))
        readings.append(Rssi(t=float(second), a="ff1", b="b1", dbm=-60.0))
    state = fused(readings)
    let_be_carried(state, "ff1", float(STOOD_S), float(NOW_S), placed=True)
    return state


def test_what_he_walked_before_is_believed() -> None:
    state = carried()
    steps = state.ledger.table("steps")
    stood = steps[:, 0] > STOOD_S
    assert (steps[stood, GIVEN] == UNSEEN).all()
    assert (steps[stood, 6] > 0.1).all()
    assert (steps[~stood, GIVEN] != UNSEEN).all()
    assert steps[~stood, 3] == pytest.approx(1.0)


def test_what_he_hears_is_of_one_place_no_longer() -> None:
    """While he was thought to stand, each power was one more of the same place."""
    stands = [tells(second, 0.0, second - 1.0) for second in range(1, 41)]
    state = fused([entered(node="ff1"), *stands, *(_heard(second) for second in range(1, 41))])
    before = state.ledger.table("pairs")[:, 8].copy()
    leave_behind(state, state.nodes["ff1"].index, 10.0, 40.0)
    after = state.ledger.table("pairs")[:, 8]
    assert after[:10] == pytest.approx(before[:10])
    assert (after[10:] < before[10:]).all()
    assert after[-1] < 10.0 < before[-1]
    assert (after >= 1.0).all()


def _heard(second: int) -> Rssi:
    return Rssi(t=float(second), a="ff1", b="b1", dbm=-60.0)
