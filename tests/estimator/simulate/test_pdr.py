"""A simulated unit errs as it is told to."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.simulate.base import TrueTrack
from estimator.simulate.pdr import PdrUnit, displacements, reckon
from estimator.simulate.walking import Leg, walk

PERFECT = PdrUnit(
    heading_sigma_rad=0.0, heading_walk_rad=0.0, noise_m=0.0, rest_noise_m=0.0, heading_noise_rad=0.0
)


@pytest.fixture
def truth() -> TrueTrack:
    legs = [Leg((50.0, 0.0, 0.0), 1.0, 10.0), Leg((50.0, 30.0, 3.0), 0.7)]
    return walk((0.0, 0.0, 0.0), legs, (), end_s=100.0)


def test_a_perfect_unit_adds_up_to_the_true_way(truth: TrueTrack) -> None:
    dead = reckon(truth, PERFECT, np.random.default_rng(0))
    assert np.allclose(np.cumsum(dead.delta_m, axis=0), truth.at(dead.t_s))
    assert np.allclose(dead.heading_rad, truth.heading_at(dead.t_s))


def test_turning_a_report_by_the_frames_error_gives_the_true_displacement(truth: TrueTrack) -> None:
    unit = PdrUnit(
        bias_radps=0.01,
        heading_walk_rad=0.0,
        heading_sigma_rad=0.0,
        scale=1.1,
        noise_m=0.0,
        rest_noise_m=0.0,
        heading_noise_rad=0.0,
    )
    dead = reckon(truth, unit, np.random.default_rng(0))
    psi = 0.01 * dead.t_s
    turned = np.stack(
        [
            np.cos(psi) * dead.delta_m[:, 0] - np.sin(psi) * dead.delta_m[:, 1],
            np.sin(psi) * dead.delta_m[:, 0] + np.cos(psi) * dead.delta_m[:, 1],
            dead.delta_m[:, 2],
        ],
        axis=1,
    )
    assert np.allclose(1.1 * np.cumsum(turned, axis=0), truth.at(dead.t_s))
    assert np.allclose(dead.heading_rad + psi, truth.heading_at(dead.t_s))


def test_heights_rise_with_the_way(truth: TrueTrack) -> None:
    dead = reckon(truth, replace(PERFECT, rises=0.02), np.random.default_rng(0))
    true_m = truth.at(dead.t_s)
    off_m = np.cumsum(dead.delta_m, axis=0) - true_m
    way_m = np.hypot(*np.diff(true_m, axis=0, prepend=0.0)[:, :2].T).cumsum()
    assert way_m[-1] > 50.0
    assert np.allclose(off_m[:, :2], 0.0)
    assert np.allclose(off_m[:, 2], 0.02 * way_m)


def test_of_a_crawl_a_share_is_told_and_all_of_a_walk() -> None:
    legs = [Leg((20.0, 0.0, 0.0), 1.0), Leg((26.0, 0.0, 0.0), 0.4)]
    crawls = walk((0.0, 0.0, 0.0), legs, (), end_s=40.0)
    dead = reckon(crawls, replace(PERFECT, crawls=0.8), np.random.default_rng(0))
    assert dead.delta_m[:, 0].sum() == pytest.approx(20.0 + 0.8 * 6.0, abs=0.3)


def test_noise_has_the_stated_spread_while_moving_and_while_standing(truth: TrueTrack) -> None:
    unit = PdrUnit(
        heading_sigma_rad=0.0, heading_walk_rad=0.0, noise_m=0.05, rest_noise_m=0.004, heading_noise_rad=0.02
    )
    exact = reckon(truth, PERFECT, np.random.default_rng(0))
    errors, turns = [], []
    for seed in range(30):
        dead = reckon(truth, unit, np.random.default_rng(seed))
        errors.append(dead.delta_m - exact.delta_m)
        turns.append(dead.heading_rad - exact.heading_rad)
    standing = np.linalg.norm(exact.delta_m, axis=1) < 0.01
    assert standing.sum() >= 9
    assert np.std([e[~standing] for e in errors]) == pytest.approx(0.05, rel=0.05)
    assert np.std([e[standing] for e in errors]) == pytest.approx(0.004, rel=0.1)
    assert np.std(turns) == pytest.approx(0.02, rel=0.05)


def test_over_a_silence_the_displacements_are_added_up(truth: TrueTrack) -> None:
    dead = reckon(truth, PERFECT, np.random.default_rng(0))
    readings = displacements("ff1", dead, silent=(20.0, 50.0))
    assert [r for r in readings if 20.0 <= r.t < 50.0] == []
    spanning = next(r for r in readings if r.t == 50.0)
    assert spanning.from_t == 19.0
    assert np.allclose(spanning.delta_m, (31.0, 0.0, 0.0))
