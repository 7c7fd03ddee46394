"""Units that save their radios, and tell each few seconds what they have summed up."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.simulate import Report, TrueTrack, paper_a
from estimator.simulate.pdr import PdrUnit
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE, SURE, outside
from tests.estimator.trackers.entry import off_m as far
from tests.estimator.trackers.entry import shown, squared_error

LASTS_S, WRONG_M = 160.0, 2.0
SEEDS = (21, 22)


def summed_up(reports: Sequence[Report], period: int) -> list[AnyReading]:
    """The readings, of displacements so many as one."""
    told: list[AnyReading] = []
    waiting: list[Displacement] = []
    for reading in (report.reading for report in reports):
        if not isinstance(reading, Displacement):
            told.append(reading)
            continue
        waiting.append(reading)
        if len(waiting) == period:
            east, north, up = np.sum([one.delta_m for one in waiting], axis=0).tolist()
            told.append(
                Displacement(
                    t=reading.t,
                    from_t=waiting[0].from_t,
                    node=reading.node,
                    delta_m=(east, north, up),
                    heading_rad=reading.heading_rad,
                )
            )
            waiting.clear()
    return told


def walk(seed: int, period: int, monkeypatch: pytest.MonkeyPatch) -> tuple[list[AnyReading], TrueTrack]:
    """A lap and a half of paper A's rectangle, with a good unit that tells a few seconds at once."""
    cheap = paper_a.unit

    def good(rng: np.random.Generator) -> PdrUnit:
        unit = cheap(rng)
        return replace(unit, bias_radps=unit.bias_radps * 0.07 / 0.3)

    monkeypatch.setattr(paper_a, "unit", good)
    built = paper_a.build(seed)
    return summed_up([r for r in built.reports if r.reading.t <= LASTS_S], period), built.truth["ff1"]


def wrong(off_m: Sequence[float], squared: Sequence[float]) -> float:
    """How often somebody is shown surely elsewhere, by how far off he is (m) and in his ellipse's metric."""
    return float(np.mean((np.array(off_m) > WRONG_M) & (np.array(squared) > SURE)))


@pytest.mark.parametrize("period", [3, 5, 8, 15])
def test_who_wears_one_is_not_shown_sure_of_a_wrong_place(
    period: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Round corners, where he passes the base, and between two reports, when nobody knows how he goes."""
    off_m, squared = list[float](), list[float]()
    for seed in SEEDS:
        readings, truth = walk(seed, period, monkeypatch)
        monkeypatch.undo()
        tracker = KirchhoffTracker()
        for second in range(int(LASTS_S) + 1):
            tracker.fold([r for r in readings if second - 1 < r.t <= second])
            found = shown(tracker)
            true_m = truth.at(np.array([found.t]))[0]
            off_m.append(far(found, true_m))
            squared.append(squared_error(found, true_m))
    assert wrong(off_m, squared) < 0.01
    assert np.mean(np.array(squared) <= INSIDE) > 0.9


@pytest.mark.parametrize("period", [5, 8])
def test_looked_back_at_he_is_inside_his_ellipse(period: int, monkeypatch: pytest.MonkeyPatch) -> None:
    readings, truth = walk(SEEDS[0], period, monkeypatch)
    track = BatchSmoother().smooth(readings)["ff1"]
    true_m = truth.at(np.array([point.t for point in track]))
    off_m = [math.dist(p.position_m[:2], here[:2]) for p, here in zip(track, true_m, strict=True)]
    squared = [outside(p.position_m, p.covariance_m2, here) for p, here in zip(track, true_m, strict=True)]
    assert wrong(off_m, squared) == 0.0
    assert np.mean(np.array(squared) <= INSIDE) > 0.9
