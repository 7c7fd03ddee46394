"""Where a boot's way is cut."""

import numpy as np
import pytest

from estimator.inertial.footholds import APART_S, AWAY_M, LATEST_S, LEAST_S, OVER_S
from estimator.inertial.progress import JITTER_MOST_S
from tests.estimator.inertial.boot_motion import BootMotion
from tests.estimator.inertial.boot_navigation import navigated, true_m
from tests.estimator.inertial.gait import STANCE_S, STEP_S, SWING_S, Stride, walked


@pytest.mark.parametrize("length_m", [0.6, 1.3, 1.6])
def test_a_way_is_cut_where_the_boot_stands_under_its_bearer(length_m: float) -> None:
    gait = walked([Stride(length_m)] * 20).noisy(np.random.default_rng(0))
    found, _ = navigated(gait.readings())
    walks = [d for d in found if 4.0 < d.t < gait.t[-1] - 3.0]
    assert len(walks) >= 15
    for d in walks:
        assert np.linalg.norm(true_m(gait, d.t) - gait.bearer_m(d.t)) < 0.05
        assert d.t - (d.from_t or 0.0) == pytest.approx(STANCE_S + SWING_S, abs=0.1)
        assert np.linalg.norm(d.delta_m[:2]) == pytest.approx(length_m, abs=0.05)


def test_who_stands_is_told_each_half_second_and_until_he_leaves() -> None:
    gait = walked([Stride()] * 3, rests_s=4.0).noisy(np.random.default_rng(0))
    found, _ = navigated(gait.readings())
    stood = [d for d in found if d.t < 4.0]
    spans_s = [d.t - (d.from_t or 0.0) for d in stood]
    assert all(LEAST_S - STEP_S <= span_s <= APART_S + 0.03 for span_s in spans_s)
    assert stood[-1].t == pytest.approx(4.0 - OVER_S, abs=0.1)
    assert found[-1].t > gait.t[-1] - APART_S - OVER_S - JITTER_MOST_S


def test_a_boot_that_never_stands_is_told_all_the_same_and_may_be_away_from_its_bearer() -> None:
    gait = BootMotion(3).rests(2.0).works(12.0, by_m=0.05, by_rad=0.5).rests(2.0).gait()
    found, _ = navigated(gait.readings())
    swings = [d for d in found if 4.0 < d.t < 13.5]
    assert len(swings) >= 4
    assert all(d.t - (d.from_t or 0.0) <= LATEST_S + OVER_S + STEP_S for d in swings)
    assert all((d.sigma_m or 0.0) > AWAY_M for d in swings if d.t - (d.from_t or 0.0) > LATEST_S - STEP_S)
    assert any((d.sigma_m or 0.0) > AWAY_M for d in swings)
