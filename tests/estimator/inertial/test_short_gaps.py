"""The way over a short gap."""

from itertools import pairwise

import numpy as np
import pytest

from estimator.inertial.boot import Boot
from estimator.inertial.short_gaps import CROSSED_S, cross, edge_of
from tests.estimator.inertial.boot_navigation import navigated, total_m, total_sigma_m, true_m
from tests.estimator.inertial.gait import STEP_S, Stride, walked


def test_a_velocity_of_third_degree_is_crossed_exactly() -> None:
    """Held against its antiderivative."""
    chance, boot = np.random.default_rng(700), Boot.new(0.0)
    shape = chance.normal(0.0, [[1.0], [5.0], [20.0], [80.0]], (4, 3))
    start_t, end_t = 10.0, 10.2

    def edge(t: float) -> np.ndarray:
        powers, slopes = np.array([1.0, t, t**2, t**3]), np.array([0.0, 1.0, 2.0 * t, 3.0 * t**2])
        return np.array([start_t + t, *(powers @ shape), *(slopes @ shape), 0.0])

    gap_s = end_t - start_t
    way = np.array([gap_s, gap_s**2 / 2.0, gap_s**3 / 3.0, gap_s**4 / 4.0]) @ shape
    led = cross(boot, "ff1", edge(0.0), edge(gap_s))
    assert led.delta_m == pytest.approx(tuple(way))
    assert led.from_t == start_t
    assert led.t == pytest.approx(end_t)


def test_who_turns_at_a_steady_rate_has_turned_by_it_on_the_other_side() -> None:
    boot, gap_s, rate_radps = Boot.new(0.0), 0.2, 2.0
    boot.held.velocity[:] = [1.0, 0.0, 0.0]
    before = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, rate_radps])
    after = edge_of(gap_s, boot, np.array([0.0, 0.0, 9.80665, 0.0, 0.0, rate_radps]))
    cross(boot, "ff1", before, after)
    turned_rad = rate_radps * gap_s
    assert boot.held.velocity == pytest.approx([np.cos(turned_rad), np.sin(turned_rad), 0.0])
    assert boot.held.attitude[:2, 0] == pytest.approx([np.cos(turned_rad), np.sin(turned_rad)])


@pytest.mark.parametrize("lost", [8, 20, 30, 40])
@pytest.mark.parametrize("at", range(900, 1120, 27))
def test_a_gap_anywhere_in_a_stride_is_crossed_as_well_as_it_says(lost: int, at: int) -> None:
    assert lost * STEP_S <= CROSSED_S
    gait = walked([Stride()] * 10)
    found, _ = navigated([gait.imu(0, at), gait.imu(at + lost, None)])
    assert all(a.t == pytest.approx(b.from_t) for a, b in pairwise(found))
    off_m = np.linalg.norm(total_m(found) - true_m(gait, found[-1].t))
    assert off_m < 3.0 * total_sigma_m(found)
    assert off_m < 0.15
