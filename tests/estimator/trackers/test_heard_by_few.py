"""Who has no unit and walks among a few fixed radios, which hear how strong his is: radios differ."""

import math
from functools import cache

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.measurements.rssi import Rssi
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE, outside
from tests.estimator.walks import from_goal_to_goal

ROOM_M, SECONDS, RATE_HZ, SPEED_MPS = (14.0, 10.0), 90, 2, 0.8
POWER_DBM, EXPONENT, OWN_DB, LINK_DB, LINK_M = -55.0, 2.2, 4.0, 3.0, 2.0
"""Powers scatter by so much each, and by so much those of one link for some metres of a way."""
PLACES_M = np.array([[0.0, 0.0], [14.0, 0.0], [14.0, 10.0], [0.0, 10.0], [7.0, 0.0], [7.0, 10.0]])


@cache
def way(seed: int) -> Array:
    """From goal to goal through the room: where he is at each reading, n × 2 (m)."""
    chance, room_m = np.random.default_rng(seed), (0.0, np.array(ROOM_M))
    start = chance.uniform(*room_m, 2)
    return from_goal_to_goal(
        chance, start, room_m, SPEED_MPS / RATE_HZ, near_m=SPEED_MPS, steps=SECONDS * RATE_HZ
    )


def measured(seed: int, radios: int, gains_db: float) -> list[AnyReading]:
    """What the first radios hear of him.

    Args:
        seed: of all that is drawn.
        radios: how many there are.
        gains_db: by how much they differ, one standard deviation (dB).
    """
    chance = np.random.default_rng(seed + 1000)
    readings: list[AnyReading] = [Node(t=0.0, node="f", role="responder")]
    for k, place in enumerate(PLACES_M[:radios].tolist()):
        readings.append(Node(t=0.0, node=f"a{k}", role="anchor", position_m=(*place, 1.0), sigma_m=0.1))
    gains = gains_db * chance.normal(0.0, 1.0, radios)
    lasting, kept = chance.normal(0.0, 1.0, radios), math.exp(-SPEED_MPS / RATE_HZ / LINK_M)
    for i, at in enumerate(way(seed)):
        lasting = kept * lasting + math.sqrt(1.0 - kept**2) * chance.normal(0.0, 1.0, radios)
        far_m = np.hypot(*(at - PLACES_M[:radios]).T)
        law = POWER_DBM - 10.0 * EXPONENT * np.log10(np.maximum(far_m, 0.3))
        heard = law + gains + LINK_DB * lasting + OWN_DB * chance.normal(0.0, 1.0, radios)
        readings += [
            Rssi(t=i / RATE_HZ, a=f"a{k}", b="f", dbm=float(dbm)) for k, dbm in enumerate(np.round(heard))
        ]
    return readings


def seconds_shown(seed: int, radios: int, gains_db: float) -> tuple[Array, Array]:
    """Squared distances from the truth in units of what is told, of all seconds: online, and smoothed."""
    tracker, places, online = KirchhoffTracker(), way(seed), list[float]()
    readings = measured(seed, radios, gains_db)
    for second in range(1, SECONDS + 1):
        tracker.fold([r for r in readings if second - 1 <= r.t < second])
        for found in tracker.estimates():
            if found.node == "f" and found.position_m is not None:
                at = places[min(round(found.t * RATE_HZ), len(places) - 1)]
                online.append(outside(found.position_m, found.covariance_m2, at))
    track = BatchSmoother().smooth(readings)["f"]
    smoothed = [
        outside(point.position_m, point.covariance_m2, places[round(point.t * RATE_HZ)])
        for point in track
        if point.t * RATE_HZ < len(places)
    ]
    return np.array(online), np.array(smoothed)


@pytest.mark.parametrize(("seed", "radios"), [(0, 4), (1, 4), (2, 6), (3, 6)])
def test_few_radios_that_differ_by_some_decibels_do_not_show_somebody_surely_elsewhere(
    seed: int, radios: int
) -> None:
    """He was for half of the time, for what they differ by is taken up by where he is."""
    online, smoothed = seconds_shown(seed, radios, gains_db=3.0)
    assert len(online) > 0.8 * SECONDS
    assert len(smoothed) > 0.9 * SECONDS
    assert (online > SURE).mean() < 0.1
    assert (smoothed > SURE).mean() < 0.1
