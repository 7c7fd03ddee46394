"""How far somebody may have gone meanwhile."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion import physics
from estimator.fusion.entering.introduce import attach_unit
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.silence import unheard_m2, unplaced_m2, wandered_m2, went_on
from estimator.fusion.tick import fold_tick
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.trackers.base import TrackerSettings
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE


@pytest.mark.parametrize("silent_s", [0.2, 1.0, 5.0])
def test_a_way_varies_as_that_of_walkers_who_change_their_speed_at_random(silent_s: float) -> None:
    chance = np.random.default_rng(1)
    walkers, step_s = 20_000, silent_s / 200.0
    keeps = math.exp(-step_s / physics.SILENT_MEMORY_S)
    speed = chance.normal(0.0, physics.SILENT_SPEED_MPS, walkers)
    way = np.zeros(walkers)
    for _ in range(200):
        before = speed
        kick = chance.normal(0.0, physics.SILENT_SPEED_MPS * math.sqrt(1.0 - keeps**2), walkers)
        speed = keeps * speed + kick
        way += 0.5 * (before + speed) * step_s
    assert wandered_m2(silent_s, 0.0) == pytest.approx(float(way.var()), rel=0.04)


@pytest.mark.parametrize("gap_s", [0.2, 0.9, 4.0])
def test_who_has_just_told_how_he_goes_goes_on_so_and_may_change_it_at_random(gap_s: float) -> None:
    chance = np.random.default_rng(2)
    walkers, step_s, told_mps = 20_000, gap_s / 200.0, 1.2
    keeps = math.exp(-step_s / physics.UNHEARD_MEMORY_S)
    speed, way = np.full(walkers, told_mps), np.zeros(walkers)
    for _ in range(200):
        before = speed
        kick = chance.normal(0.0, physics.SILENT_SPEED_MPS * math.sqrt(1.0 - keeps**2), walkers)
        speed = keeps * speed + kick
        way += 0.5 * (before + speed) * step_s
    along_s, variance_m2 = went_on(gap_s)
    assert told_mps * along_s == pytest.approx(float(way.mean()), rel=0.02)
    assert variance_m2 == pytest.approx(float(way.var()), rel=0.05)


@given(st.floats(0.1, 60.0), st.floats(0.0, 60.0))
def test_of_whom_powers_alone_tell_parts_of_a_silence_add_up_to_a_way_that_is_kept(
    one_s: float, other_s: float
) -> None:
    whole_m2 = unplaced_m2(one_s + other_s, 0.0)
    assert unplaced_m2(one_s, 0.0) + unplaced_m2(other_s, one_s) == pytest.approx(whole_m2, rel=1e-6)
    assert whole_m2 == unheard_m2(one_s + other_s, 0.0) > wandered_m2(one_s + other_s, 0.0)


@given(st.floats(0.001, 0.05))
def test_nobody_is_anywhere_at_once(silent_s: float) -> None:
    assert math.sqrt(wandered_m2(silent_s, 0.0)) == pytest.approx(
        physics.SILENT_SPEED_MPS * silent_s, rel=0.02
    )


def test_after_minutes_it_is_a_random_walk_of_a_metre_per_root_second() -> None:
    assert wandered_m2(100.0, 200.0) == pytest.approx(100.0, rel=0.03)
    assert wandered_m2(100.0, math.inf) == pytest.approx(100.0, rel=0.03)


@given(st.floats(0.01, 5.0), st.floats(0.01, 5.0))
def test_the_parts_of_a_silence_add_up(first_s: float, second_s: float) -> None:
    parts = wandered_m2(first_s, 0.0) + wandered_m2(second_s, first_s)
    assert parts == pytest.approx(wandered_m2(first_s + second_s, 0.0), rel=1e-6, abs=1e-8)


def silent_sigma_m(fixes_s: list[float]) -> float:
    """How unsure the place of a walker is whose last displacement is from 1 s, after vague fixes (m)."""
    state = FusionState()
    place = (0.0, 0.0, 0.0)
    fold_tick(state, 0.5, [Node(t=0.0, node="ff1", role="responder", position_m=place, sigma_m=0.05)])
    fold_tick(state, 1.0, [Displacement(t=1.0, from_t=0.0, node="ff1", delta_m=(0.5, 0.0, 0.0))])
    for t in fixes_s:
        fix = Position(t=t, node="ff1", position_m=place, sigma_m=(1e4, 1e4, 1e4))
        fold_tick(state, t + physics.PENDING_S + 1.0, [fix])
    rows = state.graph.rows(state.nodes["ff1"].position)
    return float(np.sqrt(state.graph.covariance()[rows, rows][0, 0]))


@pytest.mark.parametrize("unheard_s", [5.0, 15.0, 30.0])
def test_who_walks_on_along_a_corridor_unheard_is_within_what_holds_95_percent(unheard_s: float) -> None:
    corridor_mps = 0.8
    assert (corridor_mps * unheard_s) ** 2 / unheard_m2(unheard_s, 0.0) < INSIDE
    assert (corridor_mps * unheard_s) ** 2 / unheard_m2(unheard_s, math.inf) < INSIDE


def test_of_whom_nothing_is_heard_may_be_farther_than_who_is_heard_of_each_second() -> None:
    often = [float(t) for t in range(2, 10)]
    assert silent_sigma_m(often) == pytest.approx(math.sqrt(wandered_m2(8.0, 0.0)), rel=0.05)
    assert silent_sigma_m([9.0]) == pytest.approx(math.sqrt(unheard_m2(8.0, 0.0)), rel=0.05)
    assert silent_sigma_m([9.0]) > 1.5 * silent_sigma_m(often)


def test_whoever_is_silent_for_a_quarter_of_an_hour_grows_less_sure_all_the_time() -> None:
    early, late = (silent_sigma_m([float(t) for t in range(2, end, 3)]) for end in (300, 900))
    assert late == pytest.approx(early * math.sqrt(3.0), rel=0.05)


def test_a_unit_whose_first_displacement_came_too_late_is_followed_as_any_silent_one() -> None:
    state = FusionState()
    place = (0.0, 0.0, 0.0)
    fold_tick(state, 0.5, [Node(t=0.0, node="ff1", role="responder", position_m=place, sigma_m=0.05)])
    attach_unit(state, state.nodes["ff1"], None)
    for tenth in range(1, 100):
        fix = Position(t=0.1 * tenth, node="ff1", position_m=place, sigma_m=(1e4, 1e4, 1e4))
        fold_tick(state, 0.1 * tenth + physics.PENDING_S + 1.0, [fix])
    rows = state.graph.rows(state.nodes["ff1"].position)
    assert float(np.sqrt(state.graph.covariance()[rows, rows][0, 0])) > 2.5


CORNERS = {"a1": (0.0, 0.0), "a2": (40.0, 0.0), "a3": (0.0, 30.0), "a4": (40.0, 30.0)}


def followed(silent_s: range, others: Sequence[str] = ()) -> list[tuple[float, float, float]]:
    """A walker among four anchors whose unit is silent for some seconds: epoch, error and its sigma (m)."""
    chance = np.random.default_rng(6)
    tracker = KirchhoffTracker(TrackerSettings())
    tracker.fold([Node(t=0.0, node=n, role="anchor", position_m=(*m, 0.0)) for n, m in CORNERS.items()])
    walkers = {name: 10.0 + 3.0 * i for i, name in enumerate(["ff1", *others])}
    for name, north in walkers.items():
        place = (5.0, north, 0.0)
        tracker.fold([Node(t=0.0, node=name, role="responder", position_m=place, sigma_m=0.3)])
    found = []
    for second in range(1, 31):
        t, seen = float(second), list[AnyReading]()
        for name, north in walkers.items():
            at = np.array([5.0 + second, north])
            if second not in silent_s or name != "ff1":
                e, n = (np.array([1.0, 0.0]) + chance.normal(0.0, 0.03, 2)).tolist()
                seen.append(Displacement(t=t, from_t=t - 1.0, node=name, delta_m=(e, n, 0.0)))
            for anchor, corner in CORNERS.items():
                range_m = float(np.hypot(*(at - corner)) + chance.normal(0.0, 0.1))
                seen.append(Range(t=t, a=name, b=anchor, range_m=range_m, technology="uwb"))
        tracker.fold(seen)
        ff1 = {e.node: e for e in tracker.estimates()}["ff1"]
        assert ff1.position_m is not None
        assert ff1.covariance_m2 is not None
        off_m = float(np.hypot(ff1.position_m[0] - 5.0 - ff1.t, ff1.position_m[1] - 10.0))
        found.append((ff1.t, off_m, math.sqrt(ff1.covariance_m2[0] + ff1.covariance_m2[3])))
    return found


def test_who_walks_on_when_his_unit_falls_silent_is_shown_where_he_is_heard() -> None:
    """Seconds of ranges wait for displacements that may still come: they were made at different places."""
    for _, off_m, sigma_m in followed(range(16, 31)):
        assert off_m < 1.2
        assert off_m < 4.0 * sigma_m


@pytest.mark.parametrize("silent_s", [range(16, 17), range(16, 19), range(10, 26)])
@pytest.mark.parametrize("others", [(), ("ff2",)])
def test_whose_unit_reports_again_is_not_shown_where_he_was_heard_before(
    silent_s: range, others: tuple[str, ...]
) -> None:
    for t, off_m, sigma_m in followed(silent_s, others):
        if t >= silent_s.stop:
            assert off_m < 0.5
            assert off_m < 4.0 * sigma_m


def test_a_lost_packet_takes_no_steps_from_those_who_have_lost_none() -> None:
    """Who hears them both is held against the one before, and against the other where his own way has led."""
    readings: list[AnyReading] = []
    for second in range(1, 60):
        ahead = (1.0, 0.0, 0.0)
        readings.append(Displacement(t=float(second), from_t=second - 1.0, node="ff2", delta_m=ahead))
        readings.append(Range(t=second + 0.1, a="ff1", b="ff2", range_m=5.0, technology="uwb"))
        if second % 2:
            readings.append(Displacement(t=second + 0.2, from_t=second - 0.8, node="ff1", delta_m=ahead))
    state = FusionState()
    entered = {"ff1": (0.0, 0.0, 0.0), "ff2": (0.0, 5.0, 0.0)}
    named = [Node(t=0.0, node=n, role="responder", position_m=m, sigma_m=0.1) for n, m in entered.items()]
    fold_tick(state, 0.5, named)
    for tick in range(1, 62):
        fold_tick(state, float(tick), [r for r in readings if tick - 1 <= r.t < tick])
    steps = state.ledger.table("steps")
    own = steps[steps[:, 1] == state.nodes["ff2"].index]
    assert own[:, 3].sum() == pytest.approx(59.0)
    assert own[:, 3].min() > 0.0
