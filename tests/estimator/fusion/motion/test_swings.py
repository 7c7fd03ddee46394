"""What a heading that is hardly known does to places."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.estimate import Covariance6, NodeEstimate, Vector3
from estimator.fusion.motion.swings import LOOSE_RAD, arc_m2, swung_m2
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire
from estimator.trackers.base import TrackerSettings
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE, outside

WAY_M = 20.0


@given(st.floats(0.02, 3.5), st.floats(-3.0, 3.0), st.floats(0.1, 50.0))
def test_an_arc_has_the_second_moments_that_quadrature_gives(
    sigma: float, facing: float, lever_m: float
) -> None:
    lever = lever_m * np.array([np.cos(facing), np.sin(facing)])
    nodes, weights = np.polynomial.hermite_e.hermegauss(120)
    psi, share = sigma * nodes, weights / weights.sum()
    off = np.array([
        lever[0] * (np.cos(psi) - 1.0) - lever[1] * np.sin(psi),
        lever[1] * (np.cos(psi) - 1.0) + lever[0] * np.sin(psi),
    ])  # fmt: skip
    aside = np.array([-lever[1], lever[0]])
    tangent = sigma**2 * np.outer(aside, aside)
    across = sigma**2 * aside
    found = arc_m2(across, across, np.array(sigma**2))
    np.testing.assert_allclose(found + tangent, (off * share) @ off.T, atol=1e-6 * lever_m**2)


def test_a_heading_that_is_well_known_does_next_to_nothing() -> None:
    across = np.array([0.0, LOOSE_RAD**2 * WAY_M])
    found = arc_m2(across, across, np.array(LOOSE_RAD**2))
    assert np.abs(found).max() < (0.01 * WAY_M) ** 2


@given(st.integers(0, 10_000), st.integers(1, 4))
def test_what_is_left_of_a_place_is_never_less_than_nothing(seed: int, headings: int) -> None:
    """However headings are known to each other."""
    chance = np.random.default_rng(seed)
    half = chance.normal(0.0, 1.0, (headings + 2, headings + 2)) * chance.uniform(0.1, 10.0)
    known = half @ half.T
    places, turns = known[:2, :2], np.arange(2, headings + 2)
    added = swung_m2(known[None, :2, 2:], known[turns, turns])[0]
    assert np.linalg.eigvalsh(places + added)[0] > -1e-9 * np.trace(places)


def ahead(heading_sigma_rad: float, more: tuple[AnyReading, ...] = ()) -> list[AnyReading]:
    """Who walks 20 m straight ahead by his unit, which may be turned."""
    begins = Node(
        t=0.0,
        node="ff1",
        role="responder",
        position_m=(0.0, 0.0, 0.0),
        sigma_m=0.1,
        heading_sigma_rad=heading_sigma_rad,
    )
    steps = [
        Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(1.0, 0.0, 0.0))
        for t in np.arange(1.0, WAY_M + 1.0).tolist()
    ]
    return [begins, *steps, *more]


def seen(estimate: NodeEstimate) -> tuple[Vector3 | None, Covariance6 | None]:
    return estimate.position_m, estimate.covariance_m2


@pytest.mark.parametrize("turned_rad", [0.0, 0.5, 1.0, 2.0, 3.0, -2.5])
def test_whose_heading_is_unknown_may_be_anywhere_around(turned_rad: float) -> None:
    tracker = KirchhoffTracker()
    drop = Drop(t=WAY_M, node="b1", by="ff1")
    tracker.fold(ahead(math.pi, (drop, Retire(t=WAY_M + 1.0, node="b1"))))
    there = WAY_M * np.cos(turned_rad), WAY_M * np.sin(turned_rad)
    for estimate in tracker.estimates():
        assert outside(*seen(estimate), there) < INSIDE
    smoothed = BatchSmoother(TrackerSettings()).smooth(ahead(math.pi))["ff1"][-1]
    assert outside(smoothed.position_m, smoothed.covariance_m2, there) < INSIDE


def test_he_is_not_shown_farther_away_than_he_can_be() -> None:
    tracker = KirchhoffTracker()
    tracker.fold(ahead(math.pi))
    covariance = tracker.estimates()[0].covariance_m2
    assert covariance is not None
    assert covariance[0] + covariance[3] < 2.5 * WAY_M**2


def test_a_fix_held_late_of_whose_heading_is_unknown_is_worth_what_he_has_walked_since() -> None:
    """The fix is three steps old when his displacements come: in which direction has he gone on?"""
    fix = Position(t=17.0, node="ff1", position_m=(0.0, 17.0, 0.0), sigma_m=(0.1, 0.1, 0.1))
    tracker = KirchhoffTracker()
    readings = ahead(math.pi, (fix,))
    tracker.fold([r for r in readings if r.t <= 17.0])
    assert outside(*seen(tracker.estimates()[0]), (0.0, 17.0)) < INSIDE
    tracker.fold([r for r in readings if r.t > 17.0])
    assert outside(*seen(tracker.estimates()[0]), (0.0, WAY_M)) < INSIDE


@pytest.mark.parametrize("turned_rad", [0.0, 1.0, 2.0, -2.5])
def test_a_fix_shows_who_may_have_gone_anywhere_where_he_is_at_once(turned_rad: float) -> None:
    """Before all turns have been tried: the fix lies on his arc, far off its tangent."""
    there = 17.0 * math.cos(turned_rad), 17.0 * math.sin(turned_rad), 0.0
    fix = Position(t=17.0, node="ff1", position_m=there, sigma_m=(0.1, 0.1, 0.1))
    tracker = KirchhoffTracker()
    tracker.fold([r for r in ahead(math.pi, (fix,)) if r.t <= 17.0])
    (estimate,) = tracker.estimates()
    assert estimate.position_m is not None
    assert math.dist(estimate.position_m, there) < 0.5


def test_two_who_follow_one_heading_know_where_they_are_to_each_other() -> None:
    tracker = KirchhoffTracker()
    tracker.fold(ahead(math.pi, (Drop(t=WAY_M, node="b1", by="ff1"),)))
    between = tracker.relative("ff1", "b1")
    assert between is not None
    assert between.covariance_m2[0] + between.covariance_m2[3] < 2.0


def test_a_heading_that_one_radio_leaves_open_stays_open_until_he_turns() -> None:
    """To one radio beside his straight way a way to its other side looks the same (flip ambiguity)."""
    turned, base_m = 2.6, np.array([6.0, 2.0])
    facing = np.array([math.cos(turned), math.sin(turned)])
    chance = np.random.default_rng(7)
    base: AnyReading = Node(t=0.0, node="base", role="base", position_m=(6.0, 2.0, 0.0))
    ranges = [
        Range(
            t=t,
            a="ff1",
            b="base",
            range_m=float(np.linalg.norm(t * facing - base_m) + chance.normal(0.0, 0.1)),
            sigma_m=0.1,
            technology="uwb",
        )
        for t in np.arange(1.0, WAY_M + 1.0).tolist()
    ]
    tracker = KirchhoffTracker()
    readings = sorted([base, *ahead(math.pi), *ranges], key=lambda r: r.t)
    for second in range(int(WAY_M) + 1):
        tracker.fold([r for r in readings if second - 1 < r.t <= second])
        if second > 4:
            shown = next(e for e in tracker.estimates() if e.node == "ff1")
            assert outside(*seen(shown), tuple((shown.t * facing).tolist())) < INSIDE
