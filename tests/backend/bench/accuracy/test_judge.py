import math

import numpy as np
import pytest

from backend.bench.accuracy.judge import judge
from backend.bench.accuracy.outcome import Outcome, rows_of
from backend.bench.accuracy.text import cells, failures, table
from estimator.estimate import TrackPoint
from estimator.simulate import TrueTrack

T_S = np.arange(11.0)
ZEROS = np.zeros(11)
WALKS = {
    "a": TrueTrack(T_S, np.column_stack([T_S, ZEROS, ZEROS]), ZEROS.astype(np.int64), ZEROS),
    "b": TrueTrack(T_S, np.column_stack([ZEROS, 3.0 * T_S, ZEROS]), ZEROS.astype(np.int64), ZEROS),
}


def beside(node: str, off_m: float, t_s: range) -> list[TrackPoint]:
    """Points so far west of the truth."""
    points = []
    for t in t_s:
        east, north, up = WALKS[node].at(np.array([float(t)]))[0].tolist()
        covariance = (1.0, 0.0, 0.0, 1.0, 0.0, 1.0)
        points.append(TrackPoint(t=t, position_m=(east - off_m, north, up), covariance_m2=covariance))
    return points


def test_the_errors_of_all_responders_are_pooled() -> None:
    verdict = judge({"a": beside("a", 1.0, range(11)), "b": beside("b", 3.0, range(11))}, WALKS, heights=True)
    assert verdict.errors.mean_m == pytest.approx(2.0)
    assert verdict.errors.rmse_m == pytest.approx(math.sqrt(5.0))
    assert verdict.errors.max_percent == pytest.approx(100.0 * 3.0 / 20.0)
    assert verdict.errors.coverage == pytest.approx(0.5)
    assert math.isnan(verdict.errors.ve95_m)
    assert verdict.shown == 1.0


def test_epochs_without_truth_are_not_judged_and_seconds_without_estimate_are_missed() -> None:
    verdict = judge({"a": beside("a", 1.0, range(6, 16))}, WALKS, heights=True)
    assert len(verdict.drawn[0].t_s) == 5
    assert verdict.shown == pytest.approx(5 / 20)


def test_heights_are_judged_where_people_climb_and_an_entrant_estimates_them() -> None:
    up = {"a": WALKS["a"]}
    up["a"] = TrueTrack(T_S, np.column_stack([T_S, ZEROS, 0.3 * T_S]), up["a"].level, ZEROS)
    track = {"a": beside("a", 1.0, range(11))}
    assert judge(track, up, heights=True).errors.ve95_m == pytest.approx(2.85)
    assert math.isnan(judge(track, up, heights=False).errors.ve95_m)


def test_a_row_is_the_mean_over_the_seeds_that_came_to_an_end() -> None:
    outcomes = [
        Outcome("c", 0, "x", "smoothed", 1.0, judge({"a": beside("a", 1.0, range(11))}, WALKS, heights=True)),
        Outcome("c", 1, "x", "smoothed", 3.0, judge({"a": beside("a", 2.0, range(11))}, WALKS, heights=True)),
        Outcome("c", 2, "x", "smoothed", failed="lost"),
        Outcome("c", 0, "y", "online", failed="lost"),
    ]
    first, second = rows_of(outcomes)
    assert (first.mode, first.errors, failures(first)) == ("online", None, "1 of 1 failed, seed 0: lost")
    assert second.errors is not None
    assert second.errors.mean_m == pytest.approx(1.5)
    assert cells(second)[0] == "1.50"
    assert cells(second)[-1] == "2.0"
    assert "1 of 3 failed, seed 2: lost" in table("c", [first, second])


def test_how_honest_an_entrant_is_is_told_as_unsure_as_the_seeds_differ() -> None:
    """All points of a seed share how its map is turned: twenty seeds are twenty draws, however long."""
    off_m = (0.5, 1.0, 2.0, 1.0)
    outcomes = [
        Outcome("c", seed, "x", "smoothed", 1.0, judge({"a": beside("a", m, range(11))}, WALKS, heights=True))
        for seed, m in enumerate(off_m)
    ]
    nees = [run.verdict.errors.nees for run in outcomes if run.verdict is not None]
    (row,), (alone,) = rows_of(outcomes), rows_of(outcomes[:1])
    error = np.std(nees, ddof=1) / 2.0
    assert cells(row)[9] == f"{np.mean(nees):.2f}±{error:.2f}"
    assert "±" not in "".join(cells(alone))
