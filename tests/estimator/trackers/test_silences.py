"""Whose radio was silent, and who is ranged by two others only when his unit leads on again."""

import math

import numpy as np
import pytest

from estimator.fusion import physics
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE
from tests.estimator.trackers.entry import BASE, shown, squared_error

LED_S, BACK_S = 60, 20
PACE_MPS, STEP_SIGMA_M, RANGE_SIGMA_M = 0.5, 0.03, 0.1
NORTH = np.array([0.0, 1.0])
ANCHORS = {"a1": (-6.0, 0.0), "a2": (6.0, 0.0)}


def wandered(chance: np.random.Generator, at: Array, span_s: float) -> Array:
    """Where a bearer has come to who walks about as one does whose unit is silent (m)."""
    parts = round(10.0 * span_s)
    kept = math.exp(-0.1 / physics.SILENT_MEMORY_S)
    speed = chance.normal(0.0, physics.SILENT_SPEED_MPS, 2)
    for _ in range(parts):
        at = at + 0.1 * speed
        speed = kept * speed + chance.normal(0.0, physics.SILENT_SPEED_MPS * math.sqrt(1.0 - kept**2), 2)
    return at


def stepped(chance: np.random.Generator, t: float, delta_m: Array) -> Displacement:
    e, n = (delta_m + chance.normal(0.0, STEP_SIGMA_M, 2)).tolist()
    return Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(e, n, 0.0))


def ranged(chance: np.random.Generator, t: float, at_m: Array) -> list[AnyReading]:
    return [
        Range(
            t=t,
            a="ff1",
            b=name,
            range_m=float(np.hypot(*(at_m - place)) + chance.normal(0.0, RANGE_SIGMA_M)),
            sigma_m=RANGE_SIGMA_M,
        )
        for name, place in ANCHORS.items()
    ]


def errors(
    chance: np.random.Generator, left_m: Array, back_m: Array, silent_s: float, unheard: int, towards: float
) -> list[float]:
    """Squared errors of the pictures of somebody who is back from a silence.

    Args:
        chance: of it.
        left_m: where he was last heard of (m).
        back_m: where he is when his unit leads on again (m).
        silent_s: how long nothing was heard of him (s).
        unheard: his unit leads on for so many seconds before he is ranged.
        towards: where to he walks then (rad from east).
    """
    tracker, at_m = KirchhoffTracker(), left_m - PACE_MPS * LED_S * NORTH
    anchors = [Node(t=0.0, node=a, role="anchor", position_m=(*at, 0.0)) for a, at in ANCHORS.items()]
    entered = Node(t=0.0, node="ff1", role="responder", position_m=(*at_m.tolist(), 0.0), sigma_m=0.3)
    tracker.fold([BASE, *anchors, entered])
    for second in range(1, LED_S + 1):
        at_m, t = at_m + PACE_MPS * NORTH, float(second)
        tracker.fold([stepped(chance, t, PACE_MPS * NORTH), *ranged(chance, t, at_m)])
    at_m, delta_m, found = back_m, PACE_MPS * np.array([math.cos(towards), math.sin(towards)]), []
    for second in range(1, BACK_S + 1):
        at_m, t = at_m + delta_m, LED_S + silent_s + second
        tracker.fold([stepped(chance, t, delta_m), *(ranged(chance, t, at_m) if second > unheard else [])])
        found.append(squared_error(shown(tracker), at_m))
    return found


@pytest.mark.parametrize("unheard", [0, 1, 3])
@pytest.mark.parametrize("towards", [0.5, 1.6, 2.6])
def test_who_is_back_beyond_the_line_of_those_who_range_him_may_be_there(
    unheard: int, towards: float
) -> None:
    left_m, back_m = np.array([0.0, -12.0]), np.array([-3.0, 4.0])
    found = errors(np.random.default_rng(1), left_m, back_m, 90.0, unheard, towards)
    assert max(found) < SURE


def test_who_has_left_the_line_may_have_left_it_either_way() -> None:
    found = []
    for seed in range(8):
        chance, left_m = np.random.default_rng(seed), np.array([0.0, -2.0])
        back_m, towards = wandered(chance, left_m, 120.0), chance.uniform(0.0, 2.0 * math.pi)
        found += [errors(chance, left_m, back_m, 120.0, unheard, towards) for unheard in (1, 3)]
    assert np.mean(np.array(found) > SURE) < 0.01
    assert np.mean(found) < 2.0
