"""Whether those whose boots send raw samples are as far off as is said, over many units and ways."""

from collections.abc import Callable

import numpy as np
import pytest

from estimator.estimate import NodeEstimate
from estimator.fusion.physics import BESIDE_M
from estimator.measurements.node import Node
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE, outside
from tests.estimator.inertial.boot_motion import BootMotion, Unit
from tests.estimator.inertial.gait import Gait, Stride, walked

SEEDS = 20
SIGMA_M, SIGMA_RAD = 0.05, 0.03
USUAL = {"scale": 0.01, "bias_mps2": 0.1, "bias_radps": 0.01}
BAD = {"scale": 0.02, "bias_mps2": 0.2, "bias_radps": 0.05}


def around(chance: np.random.Generator) -> Gait:
    """Along corridors and around their corners."""
    corners = np.where(chance.random(25) < 0.12, chance.choice([-1.0, 1.0], 25), 0.0)
    turns = chance.normal(0.0, 0.03, 25) + corners * chance.uniform(0.5, 1.5, 25)
    return walked([Stride(chance.uniform(1.0, 1.5), turn) for turn in turns.tolist()])


def upstairs(chance: np.random.Generator) -> Gait:
    """Up a stair, and back on the level."""
    stair = [Stride(0.4, chance.normal(0.0, 0.1), 0.17) for _ in range(15)]
    return walked([*stair, *[Stride(chance.uniform(1.0, 1.5))] * 8])


def ladder(chance: np.random.Generator) -> Gait:
    """To a ladder, and up."""
    return walked([*[Stride(chance.uniform(1.0, 1.5))] * 6, *[Stride(0.03, 0.0, 0.3)] * 15])


def moves_off(chance: np.random.Generator) -> Gait:
    """Switched on just before the boot is moved."""
    begins = BootMotion().rests(chance.uniform(0.3, 0.6)).turns(chance.uniform(-0.1, 0.1), 0.5)
    return begins.walks(20).gait()


def on_in_walk(chance: np.random.Generator) -> Gait:
    """Switched on anywhere in a stride."""
    gait, first = walked([Stride()] * 25, rests_s=1.0), 200 + int(chance.integers(0, 220))
    force, rate, place_m = gait.force[first:], gait.rate[first:], gait.place_m[first:]
    return gait._replace(t=gait.t[: len(force)], force=force, rate=rate, place_m=place_m - place_m[0])


def followed(gait: Gait, chance: np.random.Generator) -> tuple[list[float], list[float]]:
    """Squared distances from where he is shown to where he is, by what is said of them: across, and up."""
    off_rad, off_m = chance.normal(0.0, SIGMA_RAD), chance.normal(0.0, SIGMA_M, 3)
    beside_m = np.append(chance.normal(0.0, BESIDE_M, 2), 0.0)
    begins = Node(
        t=0.0,
        node="ff1",
        role="responder",
        position_m=tuple(off_m.tolist()),
        sigma_m=SIGMA_M,
        heading_rad=off_rad,
        heading_sigma_rad=SIGMA_RAD,
    )
    tracker, across, up = KirchhoffTracker(), [], []
    tracker.fold([begins])
    for reading in gait.readings():
        tracker.fold([reading])
        e = shown(tracker)
        there = gait.bearer_m(e.t) + beside_m
        across.append(outside(e.position_m, e.covariance_m2, there))
        assert e.position_m is not None
        assert e.covariance_m2 is not None
        up.append((e.position_m[2] - float(there[2])) ** 2 / e.covariance_m2[5])
    return across, up


def shown(tracker: KirchhoffTracker) -> NodeEstimate:
    return next(e for e in tracker.estimates() if e.node == "ff1")


@pytest.mark.parametrize(
    ("goes", "unit", "least"),
    [
        (around, USUAL, 0.3),
        (around, BAD, 0.5),
        (upstairs, USUAL, 0.3),
        (ladder, BAD, 0.3),
        (moves_off, USUAL, 0.1),
        (on_in_walk, USUAL, 0.1),
        (on_in_walk, BAD, 0.3),
    ],
)
def test_who_walks_is_as_far_off_as_is_said(
    goes: Callable[[np.random.Generator], Gait], unit: dict[str, float], least: float
) -> None:
    """Mean squared error per degree of freedom, and how many are inside.

    Where he begins is one draw a walk: of twenty one or two may be outside most of the time.
    """
    across, up = [], []
    for seed in range(SEEDS):
        chance = np.random.default_rng((seed, 11))
        one, other = followed(Unit(seed, **unit).feels(goes(chance)), chance)
        across += one
        up += other
    assert least < 0.5 * np.mean(across) < 1.6
    assert np.mean(np.array(across) < INSIDE) > 0.85
    assert np.mean(up) < 1.6
