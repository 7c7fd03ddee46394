from collections import Counter
from itertools import pairwise

import numpy as np
import pytest

from backend.bench.speed.laps import GRID_M, Laps
from estimator.measurements import Displacement, Node, Rssi

LAPS = Laps(responders=3, breadcrumbs=20, heard=4, sweeps=5, seed=7)


def test_a_second_is_the_same_whenever_it_is_asked_for() -> None:
    fresh = Laps(*LAPS)
    assert fresh.second(9) == [Laps(*LAPS).second(t) for t in (8, 9)][1]
    assert fresh.introductions() == LAPS.introductions()
    assert LAPS.second(9) != LAPS._replace(seed=8).second(9)
    assert LAPS.second(9) != LAPS.second(10)


def test_there_are_as_many_readings_as_asked_for() -> None:
    roles = Counter(reading.role for reading in LAPS.introductions() if isinstance(reading, Node))
    assert roles == {"base": 1, "breadcrumb": 20, "responder": 3}
    readings = LAPS.second(4)
    assert Counter(type(reading) for reading in readings) == {Rssi: 3 * 4 * 5, Displacement: 3}
    assert all(3.0 < reading.t <= 4.0 for reading in readings)
    assert all(a.t <= b.t for a, b in pairwise(readings))


def test_the_nearest_breadcrumbs_are_heard_and_nearer_ones_are_louder() -> None:
    laps = Laps(responders=1, breadcrumbs=100, heard=5)
    names = [reading.node for reading in laps.introductions() if isinstance(reading, Node)]
    where = {n.node: n.position_m for n in laps.introductions() if isinstance(n, Node)}
    for second in (1, 30, 77):
        place = laps.places(np.array([float(second)]))[0, 0]
        heard = [reading for reading in laps.second(second) if isinstance(reading, Rssi)]
        assert len({reading.b for reading in heard}) == 5
        assert {reading.b for reading in heard} <= set(names)
        for reading in heard:
            position_m = where[reading.b]
            assert position_m is not None
            assert np.hypot(*(np.array(position_m[:2]) - place)) < 2.0 * GRID_M


def test_displacements_lead_along_the_true_way() -> None:
    laps = Laps(responders=2, breadcrumbs=9)
    moved = np.zeros((2, 2))
    for second in range(1, 31):
        for reading in laps.second(second):
            if isinstance(reading, Displacement):
                moved[int(reading.node[2:])] += reading.delta_m[:2]
    truth = laps.truth(30)
    for i in range(2):
        track = truth[f"ff{i}"]
        assert track.distance_m == pytest.approx(30.0, abs=2.0)
        way = track.position_m[-1] - track.position_m[0]
        assert moved[i] == pytest.approx(way[:2], abs=2.0)
