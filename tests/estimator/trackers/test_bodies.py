"""Radios are worn: what lies behind its bearer is ranged too long, and heard too weakly (decision 0100)."""

import math
from functools import cache

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.graph.variable import BODY, Variable
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node, Role
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE, outside
from tests.estimator.trackers.entry import shown

SECONDS, SEEN_S = 240, 60
BODY_M, BODY_DB = 0.5, 5.0
"""What is behind him is ranged a metre farther than what is ahead, and heard ten decibels weaker."""
PLACES_M = {"base": (0.0, 0.0), "a0": (-18.0, 14.0), "a1": (16.0, -15.0)}
SEEDS = range(3)


@cache
def walk(seed: int, powers: bool, does: float) -> tuple[list[AnyReading], Array]:
    """He goes from goal to goal and drops breadcrumbs; what he hears of all radios goes by what he faces.

    Args:
        seed: of chance.
        powers: they are heard, else ranged.
        does: what his body adds to what lies behind him against what lies beside him (m or dB).
    """
    chance = np.random.default_rng(seed)
    radios = {name: np.array(place) for name, place in PLACES_M.items()}
    readings: list[AnyReading] = [_stands(name, place) for name, place in PLACES_M.items()]
    readings.append(
        Node(
            t=0.0,
            node="ff1",
            role="responder",
            position_m=(2.0, 1.0, 0.0),
            sigma_m=0.2,
            heading_sigma_rad=0.05,
        )
    )
    at, goal, faced, way = np.array([2.0, 1.0]), chance.uniform(-15.0, 15.0, 2), np.array([1.0, 0.0]), []
    turned_rad = chance.normal(0.0, 0.05)
    for second in range(SECONDS):
        t, step_m = float(second), np.zeros(2)
        if second > 0:
            left_m = float(np.hypot(*(goal - at)))
            step_m = (goal - at) * min(1.0, 1.0 / max(left_m, 1e-9))
            at = at + step_m
            if left_m <= 1.0:
                goal = chance.uniform(-15.0, 15.0, 2)
            length_m = float(np.hypot(*step_m))
            faced = step_m / length_m if length_m > 0.3 else faced
            turned_rad += math.radians(chance.normal(0.0, 0.3))
            cosine, sine = math.cos(turned_rad), math.sin(turned_rad)
            told = np.array([[cosine, sine], [-sine, cosine]]) @ step_m + chance.normal(0.0, 0.03, 2)
            delta_m = (*told.tolist(), 0.0)
            readings.append(Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=delta_m))
            if second % 25 == 12:
                radios[f"b{second}"] = at
                readings.append(Drop(t=t, node=f"b{second}", by="ff1"))
        way.append(at)
        for name, place in radios.items():
            off_m = max(float(np.hypot(*(place - at))), 0.3)
            behind = -float(faced @ (place - at)) / off_m
            if powers and second > 0:
                dbm = -42.0 - 24.0 * math.log10(off_m) - does * behind + float(chance.normal(0.0, 3.0))
                readings.append(Rssi(t=t - 0.01, a="ff1", b=name, dbm=dbm))
            elif off_m > 0.5 and second > 0:
                range_m = abs(off_m + does * (1.0 + behind) + float(chance.normal(0.0, 0.15)))
                readings.append(Range(t=t - 0.01, a="ff1", b=name, range_m=range_m, technology="uwb"))
    return readings, np.array(way)


def _stands(name: str, place: tuple[float, float]) -> AnyReading:
    role: Role = "base" if name == "base" else "anchor"
    return Node(t=0.0, node=name, role=role, position_m=(*place, 0.0), sigma_m=0.05)


def followed(readings: list[AnyReading], way: Array) -> tuple[KirchhoffTracker, list[float], list[float]]:
    """The tracker after all; how far outside he is each second, and how far off (m)."""
    tracker, out, off_m, ordered = KirchhoffTracker(), [], [], sorted(readings, key=lambda r: r.until_t)
    start = 0
    for second in range(SECONDS):
        end = start
        while end < len(ordered) and ordered[end].until_t <= second + 0.5:
            end += 1
        tracker.fold(ordered[start:end])
        start = end
        if second >= SEEN_S:
            found = shown(tracker)
            out.append(outside(found.position_m, found.covariance_m2, way[second]))
            assert found.position_m is not None
            off_m.append(math.dist(found.position_m[:2], way[second]))
    return tracker, out, off_m


def told(tracker: KirchhoffTracker, powers: bool) -> float:
    """What bodies are thought to do (m or dB)."""
    graph = tracker._lag.state().graph
    return float(graph.value(Variable("rssi", "") if powers else Variable("range", "uwb"))[BODY])


@pytest.mark.parametrize(("powers", "does"), [(False, BODY_M), (True, BODY_DB)])
def test_who_is_seen_through_his_body_is_surely_nowhere_else(powers: bool, does: float) -> None:
    sure, off_m = 0, list[float]()
    for seed in SEEDS:
        tracker, out, off = followed(*walk(seed, powers, does))
        sure, off_m = sure + sum(one > SURE for one in out), off_m + off
        assert told(tracker, powers) == pytest.approx(does, rel=0.25)
    assert sure <= 0.02 * len(off_m)
    assert float(np.mean(off_m)) < (0.6 if powers else 0.15)


@pytest.mark.parametrize(("powers", "does"), [(False, BODY_M), (True, BODY_DB)])
def test_looked_back_at_he_is_where_he_went(powers: bool, does: float) -> None:
    for seed in SEEDS:
        readings, way = walk(seed, powers, does)
        out = [
            outside(point.position_m, point.covariance_m2, way[int(point.t)])
            for point in BatchSmoother().smooth(readings)["ff1"]
            if point.t < SECONDS - 1
        ]
        assert sum(one > SURE for one in out) <= 0.02 * len(out)


@pytest.mark.parametrize("powers", [False, True])
def test_where_no_body_is_seen_none_is_told(powers: bool) -> None:
    for seed in SEEDS:
        tracker, out, _ = followed(*walk(seed, powers, 0.0))
        assert abs(told(tracker, powers)) < (0.05 if not powers else 1.0)
        assert sum(one > SURE for one in out) == 0
