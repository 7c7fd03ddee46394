"""What a heading that is hardly known does to places."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.estimate import Covariance6, NodeEstimate, Vector3
from estimator.fusion.motion.heading_arcs import LOOSE_RAD, arcs_ahead_m2, arcs_m2, swung_m2
from estimator.graph.dense import Array
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
    (found,) = arcs_m2(across[None], np.array([sigma**2]))
    np.testing.assert_allclose(found + tangent, (off * share) @ off.T, atol=1e-6 * lever_m**2)


def test_a_heading_that_is_well_known_does_next_to_nothing() -> None:
    across = np.array([0.0, LOOSE_RAD**2 * WAY_M])
    found = arcs_m2(across[None], np.array([LOOSE_RAD**2]))
    assert np.abs(found).max() < (0.01 * WAY_M) ** 2


@given(st.integers(0, 10_000), st.integers(1, 4))
def test_what_is_left_of_a_place_is_never_less_than_nothing(seed: int, headings: int) -> None:
    """However headings are known to each other, and heights by them."""
    chance = np.random.default_rng(seed)
    known = gaussian(chance, headings + 3)
    place, turns = known[:3, :3], np.arange(3, headings + 3)
    added = swung_m2(known[None, :3, 3:], known[turns, turns])[0]
    assert np.linalg.eigvalsh(place + added)[0] > -1e-9 * np.trace(place)


def gaussian(chance: np.random.Generator, numbers: int) -> Array:
    """A covariance of numbers of all sizes, some of which are nearly told by the others."""
    half = chance.normal(0.0, 1.0, (numbers, numbers)) * 10.0 ** chance.uniform(-2.0, 1.0, numbers)
    half *= 10.0 ** chance.uniform(-1.0, 1.0, (numbers, 1))
    return np.asarray(half @ half.T)


def turned(lever_m: Array, psi: Array) -> Array:
    """Where a turn takes the end of a lever, from where it was: its turns' × 3 (m)."""
    (e, n), along, aside = lever_m, np.cos(psi) - 1.0, np.sin(psi)
    return np.column_stack([e * along - n * aside, n * along + e * aside, np.zeros(len(psi))])


def sideways(lever_m: Array) -> Array:
    """Where a small turn takes it, by the radian, 3 (m)."""
    return np.array([-lever_m[1], lever_m[0], 0.0])


@pytest.mark.parametrize("sigma", [0.3, 0.8, 1.5, 3.0])
def test_a_place_and_its_height_spread_as_samples_of_who_is_turned_do(sigma: float) -> None:
    """He is carried to p + R(ψ) l, and his height is known by ψ and by p."""
    chance, lever_m = np.random.default_rng(5), np.array([6.0, -8.0])
    psi, carried = chance.normal(0.0, sigma, 400_000), chance.normal(0.0, 1.0, (400_000, 3))
    carried = carried @ np.array([[2.0, 0.3, 0.5], [0.0, 1.0, -0.4], [0.0, 0.0, 0.5]])
    carried[:, 2] += 1.2 / sigma * psi
    linear = carried + np.outer(psi, sideways(lever_m))
    across = linear.T @ psi / len(psi)
    told = linear.T @ linear / len(psi)
    told += swung_m2(across[None, :, None], np.array([np.mean(psi**2)]))[0]
    arc = carried + turned(lever_m, psi)
    np.testing.assert_allclose(told, arc.T @ arc / len(psi), atol=0.3)


@given(st.floats(LOOSE_RAD, 13.0), st.floats(-20.0, 20.0), st.floats(-20.0, 20.0))
def test_a_place_is_with_itself_as_it_is(sigma: float, east: float, north: float) -> None:
    across, v = np.array([east, north, 0.7 * sigma]), sigma**2
    ahead = np.zeros((1, 4, 4))
    ahead[0, 3] = ahead[0, :, 3] = [*across, v]
    known = np.array([v, v])
    found = arcs_ahead_m2(np.array([across[:2], across[:2]]), known, ahead)
    np.testing.assert_allclose(found, arcs_m2(across[None], known[:1]), atol=1e-9, rtol=1e-9)


@pytest.mark.parametrize("sigma", [0.4, 1.2])
@pytest.mark.parametrize("walked_rad", [0.05, 1.0])
def test_a_place_and_the_next_one_spread_together_as_samples_do(sigma: float, walked_rad: float) -> None:
    chance, count = np.random.default_rng(6), 400_000
    psi = chance.normal(0.0, sigma, (count, 1)) + [0.0, 1.0] * chance.normal(0.0, walked_rad, (count, 1))
    levers_m = np.array([6.0, -8.0]), np.array([9.0, -5.0])
    # How he is carried further is known by how he turns between, and his height by both headings.
    first = chance.normal(0.0, 1.0, (count, 3)) + 0.5 * np.outer(psi[:, 0], [0.0, 0.0, 1.0])
    more = psi[:, 1] - psi[:, 0] * np.mean(psi[:, 0] * psi[:, 1]) / np.mean(psi[:, 0] ** 2)
    first[:, :2] += np.outer(more, [0.8, -0.6])
    second = first + chance.normal(0.0, 0.5, (count, 3)) + 0.4 * np.outer(psi[:, 1], [0.0, 0.0, 1.0])
    second[:, :2] -= np.outer(psi[:, 1], second[:, :2].T @ psi[:, 1] / np.sum(psi[:, 1] ** 2))
    carried = first, second
    linear = [c + np.outer(p, sideways(m)) for c, p, m in zip(carried, psi.T, levers_m, strict=True)]
    one, other = (np.column_stack([p, f]) for p, f in zip(linear, psi.T, strict=True))
    across = np.array([p[:, :2].T @ f / count for p, f in zip(linear, psi.T, strict=True)])
    told = one.T @ other / count
    told[:3, :3] += arcs_ahead_m2(across, np.mean(psi**2, axis=0), told[None])[0]
    arcs = [c + turned(m, p) for c, m, p in zip(carried, levers_m, psi.T, strict=True)]
    np.testing.assert_allclose(told[:3, :3], arcs[0].T @ arcs[1] / count, atol=0.3)


@given(st.integers(0, 10_000), st.sampled_from([(1.0, 1.0), (1.0, 0.0), (0.0, 1.0)]))
def test_what_lies_between_two_places_is_never_less_than_nothing(
    seed: int, loose: tuple[float, float]
) -> None:
    """However headings and places are known to each other, and where only one of both is on an arc."""
    known = gaussian(np.random.default_rng(seed), 8)
    one, other, pairs = known[:4, :4], known[4:, 4:], known[None, :4, 4:]
    variance = np.array([one[3, 3], other[3, 3]]) * loose
    own = arcs_m2(np.array([one[:3, 3], other[:3, 3]]), variance)
    together = pairs[0, :3, :3] + arcs_ahead_m2(np.array([one[:2, 3], other[:2, 3]]), variance, pairs)[0]
    joint = np.block([[one[:3, :3] + own[0], together], [together.T, other[:3, :3] + own[1]]])
    assert np.linalg.eigvalsh(joint)[0] > -1e-9 * np.trace(known)


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
