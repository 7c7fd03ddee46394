"""Who is so far from a radio is on an arc about it: nothing tells for a moment where on it he is."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion.memory.ledger import RANGE
from estimator.fusion.rows.range_curvature import arc_error, ranges_alike, sight_turns
from estimator.fusion.rows.rows import A_E, B_E, EXTRA, FIELDS, KIND, VALUE, A, B, columns_of, linearise
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.imu import Imu
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.inertial.gait import Stride, walked

SECONDS, SPEED_MPS, RANGE_SIGMA_M = 75, 1.2, 0.1


class Picture(NamedTuple):
    """How far off somebody is shown, and how sure."""

    off_m: float
    sigma_m: float


def told(readings: Sequence[AnyReading], true_m: Callable[[float], Array]) -> list[Picture]:
    """What is shown of ff1, second by second."""
    tracker, found = KirchhoffTracker(), []
    ends = np.array([r.until_t if isinstance(r, Imu) else r.t for r in readings])
    begin_t = ends.min()
    for second in range(1, int(ends.max() - begin_t) + 1):
        now = (ends > begin_t + second - 1) | ((ends == begin_t) & (second == 1))
        tracker.fold([readings[k] for k in np.flatnonzero(now & (ends <= begin_t + second)).tolist()])
        shown = next(e for e in tracker.estimates() if e.node == "ff1")
        assert shown.position_m is not None
        assert shown.covariance_m2 is not None
        ee, en, _, nn, _, _ = shown.covariance_m2
        off_m = float(np.hypot(*(shown.position_m[:2] - true_m(shown.t))))
        found.append(Picture(off_m, float(np.sqrt(np.linalg.eigvalsh([[ee, en], [en, nn]])[1]))))
    return found


def sure_for_a_moment(pictures: Sequence[Picture]) -> list[int]:
    """Pictures that are three times as sure as those before and after, and wrong."""
    sigmas_m = np.array([p.sigma_m for p in pictures])
    return [
        k
        for k in range(2, len(pictures) - 2)
        if 3.0 * sigmas_m[k] < min(np.median(sigmas_m[k - 2 : k]), np.median(sigmas_m[k + 1 : k + 3]))
        and pictures[k].off_m > 3.0 * sigmas_m[k]
    ]


def heard(true_m: Callable[[float], Array], radio_m: tuple[float, float], seed: int) -> list[AnyReading]:
    """One radio, and ranges to it twice a second."""
    chance = np.random.default_rng(seed)
    readings: list[AnyReading] = [
        Node(t=0.0, node="a1", role="anchor", position_m=(*radio_m, 0.0), sigma_m=0.05)
    ]
    for t in np.arange(0.5, SECONDS, 0.5).tolist():
        range_m = abs(float(np.hypot(*(true_m(t) - radio_m)) + chance.normal(0.0, RANGE_SIGMA_M)))
        readings.append(Range(t=t, a="ff1", b="a1", range_m=range_m, sigma_m=RANGE_SIGMA_M, technology="uwb"))
    return readings


@pytest.mark.parametrize("bias_radps", [-0.04, 0.04])
@pytest.mark.parametrize("heading_rad", [0.0, 0.7])
def test_whose_boot_drifts_beside_one_radio_is_not_sure_for_a_moment(
    bias_radps: float, heading_rad: float
) -> None:
    """His unit was switched on while he walked: only ranges tell its bias."""
    gait = walked([Stride()] * 66, heading_rad=heading_rad, rests_s=0.005)
    gait = gait._replace(rate=gait.rate + np.array([0.0, 0.0, bias_radps]))
    begins = Node(
        t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=1.0, heading_rad=heading_rad
    )

    def true_m(t: float) -> Array:
        return np.array([np.interp(t, gait.t, gait.place_m[:, axis]) for axis in range(2)])

    for seed in range(4):
        pictures = told([begins, *heard(true_m, (15.0, 13.0), seed), *gait.readings()], true_m)
        assert sure_for_a_moment(pictures) == []


def straight_m(t: float) -> Array:
    return np.array([SPEED_MPS * t, 0.0])


def reported(drift_radps: float, seed: int) -> list[AnyReading]:
    """Displacements of a straight walk by a unit that turns slowly."""
    chance, readings = np.random.default_rng((seed, 1)), list[AnyReading]()
    for t in np.arange(1.0, SECONDS).tolist():
        cosine, sine = np.cos(drift_radps * t), np.sin(drift_radps * t)
        east, north = straight_m(t) - straight_m(t - 1.0) + chance.normal(0.0, 0.03, 2)
        delta_m = float(cosine * east - sine * north), float(sine * east + cosine * north), 0.0
        readings.append(Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=delta_m))
    return readings


@pytest.mark.parametrize(
    ("heading_sigma_rad", "drift_radps", "radio_m", "seeds"),
    [
        pytest.param(0.3, 0.005, (15.0, -3.0), (0, 3), id="a unit whose heading is half known"),
        pytest.param(3.0, 0.0, (15.0, -3.0), (0, 5), id="a unit that may face anything"),
        pytest.param(None, 0.0, (15.0, 13.0), (3, 4), id="no unit"),
    ],
)
def test_who_walks_away_from_one_radio_is_not_sure_for_a_moment(
    heading_sigma_rad: float | None, drift_radps: float, radio_m: tuple[float, float], seeds: tuple[int, ...]
) -> None:
    begins = Node(
        t=0.0,
        node="ff1",
        role="responder",
        position_m=(0.0, 0.0, 0.0),
        sigma_m=0.3,
        heading_sigma_rad=heading_sigma_rad,
    )
    for seed in seeds:
        steps = [] if heading_sigma_rad is None else reported(drift_radps, seed)
        assert sure_for_a_moment(told([begins, *heard(straight_m, radio_m, seed), *steps], straight_m)) == []


def ranges(count: int) -> Array:
    """Ranges from a block at (3, 4) to a place 10 m east of it."""
    table = np.zeros((count, FIELDS))
    table[:, KIND], table[:, A], table[:, B], table[:, EXTRA] = RANGE, 0, -1, -1
    table[:, B_E], table[:, B_E + 1], table[:, VALUE] = 13.0, 4.0, 10.0
    return table


def test_a_line_of_sight_turns_with_what_is_aside_of_it() -> None:
    table, x = ranges(1), np.array([3.0, 4.0, 0.0])
    columns, jacobian, residual = columns_of(table), np.empty((1, 8)), np.empty(1)
    linearise(table, columns, x, jacobian, residual)
    aside, levers_m = np.empty((1, 8)), np.empty(1)
    sight_turns(table, columns, jacobian, residual, aside, levers_m)
    assert levers_m == pytest.approx([10.0], rel=1e-3)
    assert np.abs(aside[0, :3]) == pytest.approx([0.0, 0.1, 0.0], rel=1e-3)


@given(st.floats(-12.0, 2.0).map(lambda decades: 10.0**decades))
def test_an_arc_is_off_its_tangent_by_something_however_little_it_turns(variance: float) -> None:
    """Of the mean cosine 1 − q, E (1 − cos)² is q² (3 − 2 q + q² / 2)."""
    q = -np.expm1(-0.5 * variance)
    found = float(arc_error(np.array([variance]))[0])
    assert found > 0.0
    assert found == pytest.approx(q**2 * (3.0 - 2.0 * q + 0.5 * q**2), rel=1e-6, abs=1e-15)


def test_ranges_between_the_same_two_ends_share_their_line_whoever_measured() -> None:
    table = ranges(4)
    table[1, A_E] = 0.5  # a moment earlier
    table[2, B_E] = 14.0
    table[3, [A, B]] = table[3, [B, A]]
    table[3, A_E : A_E + 2], table[3, B_E : B_E + 2] = table[3, B_E : B_E + 2].copy(), 0.0
    assert ranges_alike(table).tolist() == [3.0, 3.0, 1.0, 3.0]
