"""What a displacement over a long time is unsure by, of a bearer whose radio was silent meanwhile."""

import math

import numpy as np
import pytest

from estimator.fusion import physics
from estimator.fusion.motion.long_displacements import RATE_M2_PER_S, alike, bridged_m2, turned_m2, walked_m
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE
from tests.estimator.trackers.entry import BASE, shown, squared_error

BIAS_RADPS = 0.002
KNOWN = (1e12, 1e12 * BIAS_RADPS)
"""What readings say of a bias that they tell well: information, and its product with the mean."""
STOOD_S, SILENT_S = 60, 120


@pytest.mark.parametrize(("bias_radps", "turn_rad"), [(BIAS_RADPS, 0.0), (0.0, 0.05), (BIAS_RADPS, 0.05)])
def test_a_frame_that_turns_on_an_unknown_way_moves_its_end(bias_radps: float, turn_rad: float) -> None:
    chance = np.random.default_rng(1)
    walkers, parts, span_s = 20_000, 200, 100.0
    steps = chance.normal(0.0, math.sqrt(RATE_M2_PER_S * span_s / parts), (walkers, parts))
    about_chord = steps - steps.mean(axis=1, keepdims=True)
    turned = np.cumsum(chance.normal(0.0, turn_rad / math.sqrt(parts), (walkers, parts)), axis=1)
    turned += bias_radps * span_s * (np.arange(parts) + 0.5) / parts
    aside_m = (turned * about_chord).sum(axis=1)
    told = (1e12, 1e12 * bias_radps)
    assert turned_m2(span_s, turn_rad**2, told) == pytest.approx(float(aside_m.var()), rel=0.05)


def test_of_a_bias_that_nothing_tells_a_gyro_may_have_any() -> None:
    assert turned_m2(60.0, 0.0, (0.0, 0.0)) == pytest.approx(
        turned_m2(60.0, 0.0, (1e12, 1e12 * physics.BIAS_SIGMA_MOST_RADPS / math.sqrt(3.0)))
    )


def test_a_displacement_of_a_second_or_two_is_the_way_itself() -> None:
    assert walked_m(2.5, 2.0) == 2.5
    assert turned_m2(2.0, 1e-4, KNOWN) == 0.0


def searched(seed: int) -> tuple[list[AnyReading], tuple[float, float]]:
    """He stands at the door, then searches rooms while his radio is silent, and comes back on the air.

    Returns:
        What his unit reports, its silent time as one displacement, and where he is then (m).
    """
    chance = np.random.default_rng(seed)
    bias_radps = float(chance.normal(0.0, BIAS_RADPS))
    readings: list[AnyReading] = [
        BASE,
        Node(
            t=0.0,
            node="ff1",
            role="responder",
            position_m=(0.0, 0.0, 0.0),
            sigma_m=0.05,
            heading_sigma_rad=0.01,
        ),
    ]
    psi, place, told, heading = 0.0, np.zeros(2), np.zeros(2), 0.0
    for second in range(1, STOOD_S + SILENT_S + 1):
        t = float(second)
        psi += bias_radps
        if second <= STOOD_S:
            seen = heading - psi + 0.003 * float(chance.normal())
            readings.append(
                Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(0.0, 0.0, 0.0), heading_rad=seen)
            )
            continue
        # Among furniture he forgets within a second or two which way he went (`physics.SILENT_MEMORY_S`).
        heading += float(chance.normal(0.0, 1.2))
        psi += float(chance.normal(0.0, physics.HEADING_WALK_RAD_PER_ROOT_M * math.sqrt(0.8)))
        way = 0.8 * np.array([math.cos(heading), math.sin(heading)])
        place = place + way
        cosine, sine = math.cos(psi), math.sin(psi)
        noise = physics.WALK_M_PER_ROOT_M * math.sqrt(0.8) * chance.normal(size=2)
        told += np.array([cosine * way[0] + sine * way[1], cosine * way[1] - sine * way[0]]) + noise
    end = float(STOOD_S + SILENT_S)
    east, north = told.tolist()
    readings.append(Displacement(t=end, from_t=float(STOOD_S), node="ff1", delta_m=(east, north, 0.0)))
    return readings, (float(place[0]), float(place[1]))


def test_who_comes_back_from_a_silent_search_is_shown_as_unsure_as_his_unit_leaves_him() -> None:
    squared = []
    for seed in range(40):
        readings, place = searched(seed)
        tracker = KirchhoffTracker()
        tracker.fold(readings)
        squared.append(squared_error(shown(tracker), place))
    assert max(squared) < SURE
    assert 0.5 < float(np.mean(squared)) / 2.0 < 1.5


def test_a_place_inside_a_long_displacement_is_that_of_a_brownian_bridge() -> None:
    marks_t = np.array([0.0, 2.0, 10.0, 11.0])
    times = np.array([-1.0, 0.0, 1.0, 2.0, 4.0, 6.0, 10.0, 10.5, 12.0])
    assert bridged_m2(marks_t, times).tolist() == [0.0, 0.0, 0.0, 0.0, 1.5, 2.0, 0.0, 0.0, 0.0]
    assert bridged_m2(marks_t[:1], times).tolist() == [0.0] * len(times)


def test_however_many_readings_share_a_way_that_nobody_knows_together_they_tell_no_more_than_it_allows() -> (
    None
):
    """Their average is off by as much as the average of a bridge about its chord: q T / 12."""
    marks_t, span_s, noise_m2 = np.array([0.0, 8.0]), 8.0, 1.0
    for count in (8, 40, 400):
        times = span_s / 3.0 + (np.arange(count) + 0.5) * span_s / 3.0 / count
        told = 1.0 / (noise_m2 + alike(marks_t, times) * bridged_m2(marks_t, times))
        # Half of them tell of one axis.
        assert 1.0 / (0.5 * told.sum()) > span_s / 12.0
    assert alike(marks_t, np.array([1.0, 9.0])).tolist() == [1.0, 1.0]
