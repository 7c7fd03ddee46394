"""Somebody of whom moments are missing."""

import math

import numpy as np
import pytest

from estimator.estimate import NodeEstimate
from estimator.fusion import physics
from estimator.fusion.motion.coasting import mark_after, missed_m2, onward_m, went_on_m2
from estimator.fusion.motion.silence import went_on
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.rssi import Rssi
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE, SURE, outside
from tests.estimator.inertial.boot_navigation import true_m
from tests.estimator.inertial.gait import Stride, walked
from tests.estimator.walks import BEGINS


def test_whoever_walks_goes_on_at_his_pace_and_whoever_stands_stays() -> None:
    walks = [(float(t), 1.2 * t, 0.3 * t, 0.0) for t in range(5)]
    assert onward_m(walks, 1.0, 0.0) == pytest.approx((1.2 * went_on(1.0)[0], 0.3 * went_on(1.0)[0], 0.0))
    assert onward_m([(float(t), 5.0, 1.0, 0.0) for t in range(5)], 1.0, 0.0) == (0.0, 0.0, 0.0)
    assert onward_m(walks[:1], 1.0, 0.0) == (0.0, 0.0, 0.0)


def test_a_gap_in_two_parts_leads_as_far_as_the_whole() -> None:
    trail = [(float(t), 1.2 * t, 0.0, 0.0) for t in range(5)]
    one, other = onward_m(trail, 0.7, 0.0), onward_m(trail, 0.6, 0.7)
    assert one[0] + other[0] == pytest.approx(onward_m(trail, 1.3, 0.0)[0])
    assert mark_after(trail[-1], 5.0, (1.0, 2.0, 3.0)) == pytest.approx((5.0, 5.8, 2.0, 3.0))


def test_gaps_of_one_walk_are_as_unsure_together_as_one_of_their_length() -> None:
    parts = sum(missed_m2(0.5, 0.5 * k, raw=False) for k in range(12))
    assert parts == pytest.approx(missed_m2(6.0, 0.0, raw=False))
    # A walk straight on at 1.2 m/s along an axis is well inside.
    assert (1.2 * 6.0) ** 2 / parts < INSIDE


def pictures(readings: list[AnyReading]) -> list[NodeEstimate]:
    tracker, found = KirchhoffTracker(), []
    tracker.fold([BEGINS])
    for reading in readings:
        tracker.fold([reading])
        found += tracker.estimates()
    return found


def test_a_walker_half_of_whose_displacements_are_lost_is_not_left_behind() -> None:
    """He walks straight on; each displacement tells of its own second."""
    told = [
        Displacement(t=float(t), node="ff1", delta_m=(1.2, 0.0, 0.0), from_t=t - 1.0, heading_rad=0.0)
        for t in range(1, 61)
        if t < 4 or t % 2 == 0
    ]
    shown = pictures(list(told))
    assert shown[-1].position_m is not None
    assert math.dist(shown[-1].position_m, (72.0, 0.0, 0.0)) < 5.0
    assert max(outside(e.position_m, e.covariance_m2, (1.2 * e.t, 0.0)) for e in shown[1:]) < INSIDE


def test_nor_where_powers_are_heard_meanwhile_which_tell_no_pace() -> None:
    """Of one radio across his way; were each second that is lost a standstill, he would be 30 m behind."""
    told: list[AnyReading] = [
        Node(t=0.0, node="a1", role="anchor", position_m=(36.0, 40.0, 0.0), sigma_m=0.1)
    ]
    for second in range(1, 61):
        if second < 4 or second % 2 == 0:
            moved = Displacement(t=float(second), node="ff1", delta_m=(1.2, 0.0, 0.0), from_t=second - 1.0)
            told.append(moved)
        t = second + 0.5
        away_m = math.hypot(1.2 * t - 36.0, 40.0)
        told.append(Rssi(t=t, a="ff1", b="a1", dbm=physics.RSSI_POWER_DBM - 25.0 * math.log10(away_m)))
    (found,) = [shown for shown in pictures(told)[-2:] if shown.node == "ff1"]
    assert found.position_m is not None
    assert math.dist(found.position_m, (1.2 * found.t, 0.0, 0.0)) < 5.0


@pytest.mark.parametrize("each", [100, 200])
@pytest.mark.parametrize("seed", [702, 703])
def test_a_boot_half_of_whose_readings_are_lost_is_where_its_ellipse_says(each: int, seed: int) -> None:
    gait = walked([Stride()] * 40).noisy(np.random.default_rng(seed))
    heard = [r for i, r in enumerate(gait.readings(each)) if r.t < 4.0 or i % 2 == 0]
    shown = [e for e in pictures(list(heard)) if e.t > 1.0]
    off = [outside(e.position_m, e.covariance_m2, true_m(gait, e.t)) for e in shown]
    assert max(off) < SURE
    assert np.mean(np.array(off) < INSIDE) > 0.9
    assert shown[-1].t > heard[-1].t - 2.0
    assert shown[-1].position_m is not None
    way_m = gait.place_m[-1][0]
    assert math.dist(shown[-1].position_m, true_m(gait, shown[-1].t)) < (0.4 if each == 100 else 0.25) * way_m


def test_of_whom_a_report_told_a_moment_he_goes_on_as_one_whose_velocity_is_known() -> None:
    for span_s in (1.0, 3.0, 8.0):
        assert went_on_m2(span_s, 1e-3) == pytest.approx(went_on(span_s)[1], rel=1e-2)
        assert went_on_m2(span_s, 5.0) > 1.2 * went_on(span_s)[1]
    assert went_on_m2(0.0, 5.0) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(("span_s", "told_s"), [(2.0, 5.0), (6.0, 8.0)])
def test_how_far_he_goes_on_of_whom_only_a_mean_is_told_scatters_as_foretold(
    span_s: float, told_s: float
) -> None:
    """Velocities that are forgotten with time (Ornstein and Uhlenbeck 1930), drawn in steps."""
    chance, step_s = np.random.default_rng(1), 0.05
    keep = math.exp(-step_s / physics.UNHEARD_MEMORY_S)
    speed_mps = chance.normal(0.0, physics.SILENT_SPEED_MPS, 40_000)
    told_m, onward = np.zeros(len(speed_mps)), np.zeros(len(speed_mps))
    for k in range(round((told_s + span_s) / step_s)):
        (told_m if k * step_s < told_s - 1e-9 else onward)[:] += speed_mps * step_s
        turned = chance.normal(0.0, physics.SILENT_SPEED_MPS * math.sqrt(1.0 - keep**2), len(speed_mps))
        speed_mps = keep * speed_mps + turned
    off_m = onward - told_m / told_s * went_on(span_s)[0]
    assert went_on_m2(span_s, told_s) == pytest.approx(float(off_m.var()), rel=0.05)
