"""Where north is, nobody learns from readings between nodes: not from steps, not when places are moved."""

from collections.abc import Iterator
from itertools import groupby

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.simulate import scenario
from estimator.simulate.base import Report
from estimator.smoothing.chain.chain import Remainder
from estimator.smoothing.keyframes.displacement_sums import Way
from estimator.smoothing.keyframes.walks import unit_motion
from estimator.smoothing.problem.gauge_turn import turn_between, turned
from estimator.trackers.base import TrackerSettings
from estimator.trackers.lag import Lag
from tests.estimator.smoothing.map_rotation import (
    HEADING_SIGMA_RAD,
    turned_map,
    walk_from_afar,
    walk_past_beacons,
)
from tests.estimator.smoothing.readings.test_jacobians import steps_of, unit_states
from tests.estimator.smoothing.windows import fused, problem_of, random_state

seeds = st.integers(0, 10_000)
BASE_M = np.zeros(2)


def turn_of_walk(states: Array) -> Array:
    """What a turn of the map about the base does to units' numbers, k × 6: places J p, headings 1."""
    found = np.zeros(states.shape)
    found[:, 0], found[:, 1], found[:, 3] = -states[:, 1], states[:, 0], 1.0
    return found


@given(seeds)
def test_a_way_that_is_turned_as_a_whole_fits_as_it_did(seed: int) -> None:
    """Wherever its keyframes are: a step whose ends do not fit says nothing of north either."""
    chance = np.random.default_rng(seed)
    way, times = Way(0.0, steps_of(seed), (1.0, 1.0)), np.sort(chance.uniform(0.0, 40.0, 5))
    states = unit_states(chance, 5)
    motion = unit_motion(way.between(times[:-1], times[1:]), np.diff(times), states)
    turn = turn_of_walk(states)
    for k in range(4):
        assert motion.transition[k] @ turn[k] == pytest.approx(turn[k + 1], abs=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_a_window_knows_of_north_what_was_said_of_headings(seed: int) -> None:
    problem = WALKED
    layout = problem.layout
    assert len(layout.stands) == 2
    x = random_state(problem, seed)
    linear, motions = problem.linearise(x), problem.motions(x)
    problem.rows.widen(x, linear.jacobian)
    chain = problem.assemble(x, linear, problem.weigh(linear.residual), motions)
    left = chain.remainder(layout.length - 1)
    last = turned_map(layout, x, 0.0)[1][(layout.length - 1) * layout.width :]
    known = float(last @ left.matrix @ last)
    # Beside what was said, the entry and the bearing of who stands are known next to not at all.
    assert known == pytest.approx(1.0 / HEADING_SIGMA_RAD**2, rel=0.1)


@given(seeds)
def test_what_was_linearised_elsewhere_knows_no_turn_of_where_places_are_now(seed: int) -> None:
    problem, chance = WALKED, np.random.default_rng(seed)
    layout = problem.layout
    size, width = layout.length * layout.width, layout.width
    now = layout.start()
    now[size:] += chance.normal(0.0, 3.0, layout.border)
    was = now.copy()
    for start in layout.stands.values():
        far = 0.4 * np.hypot(*now[size + start : size + start + 2])
        was[size + start : size + start + 2] += far * chance.uniform(-0.7, 0.7, 2)
    old, new = (turned_map(layout, at, 0.0)[1][size - width :] for at in (was, now))
    rows = chance.normal(0.0, 1.0, (2 * len(old), len(old)))
    rows -= np.outer(rows @ old, old) / (old @ old)
    found = turned(Remainder(rows.T @ rows, rows.T @ np.ones(len(rows))), layout, BASE_M, was, now)
    stiff = float(np.abs(found.matrix).max() * (new @ new))
    near = np.array([np.hypot(*now[size + s : size + s + 2]) for s in layout.stands.values()])
    # Of a place at r m from the base, 1 m² / r² of the way that it has moved is left as it was.
    assert float(new @ found.matrix @ new) < 2.0 * stiff * float((1.0 / (near**2 + 1.0)).max()) ** 2 + 1e-9
    assert float(np.linalg.eigvalsh(found.matrix)[0]) > -1e-9 * float(np.abs(found.matrix).max())


@given(st.floats(-7.0, 7.0), st.floats(-7.0, 7.0), st.floats(-7.0, 7.0))
def test_who_crosses_the_base_has_not_turned_the_map_by_half(east: float, was_e: float, was_n: float) -> None:
    was_m = np.array([[was_e, was_n]])
    known = np.array([1.0])
    by_rad = [turn_between(was_m, np.array([[east, north]]), known) for north in (-1e-6, 1e-6)]
    assert np.abs(by_rad).max() < np.pi / 2
    assert by_rad[0] == pytest.approx(by_rad[1], abs=1e-4)


@pytest.mark.parametrize("by_rad", [0.0, -0.3])
def test_a_breadcrumb_of_which_nothing_is_known_turns_no_map_by_being_elsewhere(by_rad: float) -> None:
    was_m = np.array([[12.0, 3.0], [-5.0, 14.0], [9.0, -11.0], [8.0, 2.0]])
    cosine, sine = np.cos(by_rad), np.sin(by_rad)
    now_m = was_m @ np.array([[cosine, sine], [-sine, cosine]])
    now_m[3] = 7.0, -82.0
    known_per_m2 = np.array([9.0, 4.0, 16.0, 1e-6])
    others = turn_between(was_m[:3], now_m[:3], known_per_m2[:3])
    assert turn_between(was_m, now_m, known_per_m2) == pytest.approx(others, abs=1e-4)
    assert others == pytest.approx(by_rad, abs=0.01)


def test_a_place_that_has_jumped_is_left_as_it_was_said() -> None:
    layout = WALKED.layout
    now = layout.start()
    was = now.copy()
    was[layout.length * layout.width :] *= -1.0
    size = layout.width + layout.border
    left = Remainder(np.eye(size), np.ones(size))
    assert turned(left, layout, BASE_M, was, now) is left


def test_who_begins_away_from_any_base_does_not_learn_where_north_is_from_beacons() -> None:
    """Also when his first minutes have left the window: where he began holds the map, and nothing else."""
    sigmas_rad = headings_known(walk_from_afar(460.0))
    begun_rad = 3.0 * HEADING_SIGMA_RAD
    assert np.median(sigmas_rad[200:300]) == pytest.approx(begun_rad, rel=0.1)
    assert np.median(sigmas_rad[400:]) == pytest.approx(begun_rad, rel=0.1)


def test_nobody_learns_where_north_is_from_a_vehicle_that_he_does_not_hear() -> None:
    """Turned with the map, as if nobody had told where it stands, it had north known to 0.05 rad."""
    begun_rad = 3.0 * HEADING_SIGMA_RAD
    beside = headings_known(walk_from_afar(460.0, vehicle_m=(45.0, 30.0)))
    assert beside == pytest.approx(headings_known(walk_from_afar(460.0)), rel=0.05)
    assert np.median(beside[400:]) == pytest.approx(begun_rad, rel=0.1)


def test_in_twenty_minutes_nobody_learns_where_north_is() -> None:
    """Three units search two storeys; only what they said of their headings at the door is absolute."""
    at_s, known = zip(*north(scenario("two-hours", 4).reports, 1200.0), strict=True)
    early = min(k for t, k in zip(at_s, known, strict=True) if t <= 300.0)
    late = float(np.median([k for t, k in zip(at_s, known, strict=True) if t > 1000.0]))
    assert late < 1.5 * early


def headings_known(readings: list[AnyReading]) -> list[float]:
    """How sure the live view is of the heading of the only unit (rad), after each of its displacements."""
    lag, found = Lag(TrackerSettings().lag_s, FusionState()), []
    for _, told in groupby(readings, key=lambda reading: reading.until_t):
        lag.add(list(told))
        graph = lag.state().graph
        row = next((row for variable, row in graph.starts.items() if variable.kind == "unit"), None)
        if row is not None:
            found.append(float(np.sqrt(graph.covariance()[row, row])))
    return found


def north(reports: tuple[Report, ...], until_s: float) -> Iterator[tuple[float, float]]:
    """What the live view knows of where the map is turned to (1/rad²), every ten seconds."""
    lag, shown_s = Lag(TrackerSettings().lag_s, FusionState()), 10.0
    for report in reports:
        if report.sent_s > until_s:
            return
        if report.sent_s >= shown_s:
            graph = lag.state().graph
            turn = np.zeros(graph.size)
            for variable, row in graph.starts.items():
                if variable.kind == "unit":
                    turn[row] = 1.0
                elif variable.kind == "position":
                    turn[row], turn[row + 1] = -graph.reference[row + 1], graph.reference[row]
            yield shown_s, float(turn @ graph.information @ turn)
            shown_s += 10.0
        lag.add([report.reading])


WALKED = problem_of(fused(walk_past_beacons()))
