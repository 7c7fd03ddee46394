"""Two without units among a base and what they have dropped: distances alone do not tell where north is."""

from functools import lru_cache

import numpy as np
import pytest

from estimator.fusion.images import turned_about
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE, SURE, outside

RATE_HZ, SPEED_MPS, SIGMA_M = 1, 1.0, 0.1
CORNERS_M = np.array([[0.0, 0.0], [2.0, 22.0], [26.0, 24.0], [28.0, 6.0], [6.0, 4.0]])
ABREAST_M = np.array([1.5, -1.5])
"""How far the second one walks beside the first."""
DROPPED_S = (12, 24, 36, 48, 60)
ANCHOR_M = np.array([-10.0, 15.0])
SINCE_S, ANCHOR_S, TOLD_S, UNTIL_S = 15, 66, 72, 75
"""It is asked where they are shown; another told place ranges them; has told north; and the end."""
TURNS = [turned_about(np.zeros(2), by_rad) for by_rad in np.radians([0.0, 60.0, 90.0, 180.0, 270.0])]


def way() -> Array:
    """Where both are, each second: n × 2 × 2 (m)."""
    gone_m = np.concatenate([[0.0], np.linalg.norm(np.diff(CORNERS_M, axis=0), axis=1).cumsum()])
    along_m = SPEED_MPS * np.arange(UNTIL_S * RATE_HZ) / RATE_HZ
    first = np.stack([np.interp(along_m, gone_m, axis) for axis in CORNERS_M.T], axis=1)
    return np.stack([first, first + ABREAST_M], axis=1)


def introduced(places_m: Array) -> list[AnyReading]:
    """The base, another told place, and both, with where they begin."""
    nodes: list[AnyReading] = [Node(t=0.0, node="base", role="base", position_m=(0.0, 0.0, 0.0))]
    nodes += [Node(t=0.0, node="a", role="anchor", position_m=(*ANCHOR_M.tolist(), 0.0))]
    for k, at in enumerate(places_m[0].tolist()):
        nodes.append(Node(t=0.0, node=f"f{k}", role="responder", position_m=(*at, 0.0), sigma_m=1.0))
    return nodes


def readings_of(
    second: int, places_m: Array, chance: np.random.Generator, anchor_s: float = ANCHOR_S
) -> list[AnyReading]:
    """What both measure and drop in a second; the other told place ranges them from `anchor_s` on."""
    found: list[AnyReading] = []
    if second in DROPPED_S:
        found.append(Drop(t=float(second), node=f"b{second}", by="f0"))
    stand_m = {"base": np.zeros(2)}
    stand_m |= {f"b{s}": places_m[s * RATE_HZ, 0] for s in DROPPED_S if s <= second}
    if second >= anchor_s:
        stand_m["a"] = ANCHOR_M
    for i in range(second * RATE_HZ, (second + 1) * RATE_HZ):
        pairs = [
            (f"f{k}", at, name, there) for k, at in enumerate(places_m[i]) for name, there in stand_m.items()
        ]
        pairs.append(("f0", places_m[i, 0], "f1", places_m[i, 1]))
        for a, at, b, there in pairs:
            range_m = abs(float(np.linalg.norm(at - there) + chance.normal(0.0, SIGMA_M)))
            found.append(Range(t=i / RATE_HZ, a=a, b=b, range_m=range_m, technology="uwb"))
    return found


@lru_cache
def followed(seed: int) -> Array:
    """How far outside their ellipses both are, were the world turned, from `SINCE_S` on: k × 2 × turns."""
    tracker, chance, places_m = KirchhoffTracker(), np.random.default_rng(seed), way()
    tracker.fold(introduced(places_m))
    found = []
    for second in range(UNTIL_S):
        tracker.fold(readings_of(second, places_m, chance))
        if second >= SINCE_S:
            told = {one.node: one for one in tracker.estimates()}
            both = [told[f"f{k}"] for k in (0, 1)]
            at_m = [places_m[round(one.t * RATE_HZ), k] for k, one in enumerate(both)]
            found.append(
                [
                    [outside(one.position_m, one.covariance_m2, image.of(at)) for image in TURNS]
                    for one, at in zip(both, at_m, strict=True)
                ]
            )
    return np.array(found)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_both_are_inside_their_ellipses_however_the_world_is_turned(seed: int) -> None:
    assert followed(seed)[: ANCHOR_S - SINCE_S].max() < INSIDE


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_second_told_place_that_ranges_them_tells_north(seed: int) -> None:
    told = followed(seed)[TOLD_S - SINCE_S :]
    assert told[:, :, 0].max() < SURE
    assert told[:, :, 2:].min() > SURE
