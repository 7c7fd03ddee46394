"""Readings of a link as if it had been read once a second."""

import math

import numpy as np
import pytest

from estimator.fusion.learned.link_correlation import ALIKE, NEW, follow
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.smoothing.readings.thinning import once_a_second
from estimator.trackers.kirchhoff import KirchhoffTracker

SECONDS, WALKED_MPS = 30, 1.2


def followed(per_s: int) -> tuple[Array, Array]:
    """Epochs, and how many readings are alike, of a link that is read so often while an end walks."""
    link, t_s = np.array(NEW), np.arange(SECONDS * per_s) / per_s
    alike = []
    for t in t_s:
        follow(link, t, WALKED_MPS * t)
        alike.append(link[ALIKE])
    return t_s, np.array(alike)


@pytest.mark.parametrize("per_s", [2, 5, 10])
def test_a_link_that_is_read_often_is_asked_as_one_that_is_read_once_a_second(per_s: int) -> None:
    t_s, alike = followed(per_s)
    chosen, rarer = once_a_second(t_s, np.zeros(len(t_s), dtype=np.int64), alike)
    seldom_s, as_seldom = followed(1)
    assert t_s[chosen] == pytest.approx(seldom_s)
    assert rarer[chosen] == pytest.approx(as_seldom)


def test_who_reads_once_a_second_is_asked_of_all_and_links_are_asked_one_by_one() -> None:
    t_s, alike = followed(1)
    late_s = t_s + 0.3
    both_s, both = np.concatenate([t_s, late_s]), np.concatenate([alike, alike])
    order = np.argsort(both_s, kind="stable")
    link = np.repeat([0, 1], len(t_s))[order]
    chosen, rarer = once_a_second(both_s[order], link, both[order])
    assert len(chosen) == len(both_s)
    assert rarer == pytest.approx(both[order])


def test_what_is_of_no_link_stays() -> None:
    chosen, rarer = once_a_second(np.zeros(3), np.full(3, -1), np.ones(3))
    assert chosen.tolist() == [0, 1, 2]
    assert rarer.tolist() == [1.0] * 3
    assert len(once_a_second(np.zeros(0), np.zeros(0, dtype=np.int64), np.zeros(0))[0]) == 0


KICKED_T, KICKED_M = 60.0, (2.5, 0.0)
PLACES_M = {f"b{k}": (12.0 * math.cos(1.2 * k), 12.0 * math.sin(1.2 * k)) for k in range(5)}


def circling_m(t: float) -> tuple[float, float]:
    """Where somebody is who walks round among breadcrumbs, 1 m/s."""
    return 8.0 * math.cos(t / 8.0), 8.0 * math.sin(t / 8.0)


def hears_a_kick(per_s: int, until_s: int) -> list[AnyReading]:
    """Displacements, and ranges to five breadcrumbs, of which one is kicked while he hears it."""
    chance = np.random.default_rng(0)
    readings: list[AnyReading] = [
        Node(t=0.0, node=name, role="breadcrumb", position_m=(*place, 0.0), sigma_m=0.3)
        for name, place in PLACES_M.items()
    ]
    begins = (*circling_m(0.0), 0.0)
    readings.append(
        Node(t=0.0, node="ff1", role="responder", position_m=begins, sigma_m=0.1, heading_sigma_rad=0.02)
    )
    before = np.array(circling_m(0.0))
    for t in (np.arange(1, until_s * per_s) / per_s).tolist():
        here = np.array(circling_m(t))
        east, north = (here - before + chance.normal(0.0, 0.01, 2)).tolist()
        before = here
        readings.append(Displacement(t=t, node="ff1", delta_m=(east, north, 0.0), from_t=t - 1.0 / per_s))
        for name, place in PLACES_M.items():
            kicked = name == "b2" and t >= KICKED_T
            lies = np.array(place) + (KICKED_M if kicked else (0.0, 0.0))
            range_m = float(np.hypot(*(here - lies)) + chance.normal(0.0, 0.15))
            readings.append(Range(t=t, a="ff1", b=name, range_m=range_m, technology="uwb"))
    return readings


@pytest.mark.parametrize("per_s", [1, 2, 5, 10])
def test_a_kick_is_noticed_however_often_somebody_measures_to_the_breadcrumb(per_s: int) -> None:
    """It may look like an echo at first: ranges that jump, and stay longer or shorter."""
    readings = hears_a_kick(per_s, 90)
    tracker, moved = KirchhoffTracker(), []
    for second in range(90):
        tracker.fold([r for r in readings if math.floor(r.t) == second])
        tracker.estimates()
        moved += [n.node for n in tracker.take_notices() if n.code == "node_moved"]
    assert moved == ["b2"]
