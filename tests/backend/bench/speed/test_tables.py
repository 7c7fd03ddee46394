import math
from pathlib import Path

import pytest

from backend.bench.accuracy import cases
from backend.bench.speed import growth, real_time, same_graph, size, smoothed
from backend.bench.speed.contestants import Isam, Ours
from backend.bench.speed.growth import Span
from backend.bench.speed.laps import UNTOLD_RAD, Laps
from backend.bench.speed.race import race
from backend.bench.speed.run import run
from backend.errors import CommandRefused
from estimator.measurements import Displacement, Node
from tests.backend.bench.accuracy.short import NAME, build, true_track


def test_all_contestants_come_through_a_short_walk(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cases, "scenario_names", lambda: [NAME])
    monkeypatch.setattr(cases, "scenario", lambda _, seed: build(seed))
    case = cases.case_of(NAME, 0, Path())
    assert case.truth["ff"].distance_m == true_track().distance_m
    told = same_graph.pooled([case])
    assert [one.name for one in told] == ["firethread", "iSAM2, skip 10", "iSAM2, skip 1"]
    for one in told:
        [only] = one.runs
        assert only.failed is None
        assert len(only.spent) == 61
        assert only.readings == len(case.reports)
        assert all(0.0 <= spent.estimates_s <= spent.whole_s for spent in only.spent)
        assert one.rmse_m < 0.5
    assert "bar: at most 0.5 of iSAM2, skip 1, RMSE not above its" in same_graph.report(NAME, told)


def test_who_works_too_long_has_to_stop_and_the_others_go_on() -> None:
    laps = Laps(1, 9)
    seconds = [laps.second(t) for t in range(1, 6)]
    slow, quick = race(seconds, [Ours(), Isam(10)], laps.introductions(), longest_s=1e-9)
    assert slow.failed == quick.failed == "stopped in second 1, after 1e-09 s of work"
    assert len(slow.spent) == 1
    [through] = race(seconds, [Isam(10)], laps.introductions())
    assert through.failed is None
    assert through.readings == sum(len(second) for second in seconds)


def test_size_and_real_time_print_their_tables(capsys: pytest.CaptureFixture[str]) -> None:
    size.run((2,), breadcrumbs=9, duration_s=5)
    real_time.run(Laps(2, 9, heard=3, sweeps=2), duration_s=5)
    told = capsys.readouterr().out
    assert "2 responders" in told
    assert "iSAM2, skip 10 + covariances" in told
    assert "share of one core: 0." in told
    assert "bar: at most 0.5 of one core: " in told


def test_the_smoothed_view_is_timed_by_the_clock(capsys: pytest.CaptureFixture[str]) -> None:
    taken = smoothed.measure(Laps(1, 9), 20)
    assert taken.readings == 1 + 9 + 1 + 20 * 7
    assert len(taken.alone) == len(taken.running) == smoothed.TIMES
    assert taken.rmse_m < 3.0
    smoothed.run([Laps(1, 9), Laps(1, 9, told=False)], duration_s=5)
    told = capsys.readouterr().out
    assert told.count("bar: within 5 s: met") == 4
    assert "headings told" in told
    assert "headings untold" in told


def test_a_unit_that_nobody_has_told_what_it_faces_reports_the_same_steps_turned() -> None:
    steps = {}
    for told in (True, False):
        laps = Laps(2, 9, told=told)
        assert {r.heading_sigma_rad for r in laps.introductions() if isinstance(r, Node)} >= {
            None if told else UNTOLD_RAD
        }
        steps[told] = [r.delta_m for r in laps.second(7) if isinstance(r, Displacement)]
    for one, other in zip(steps[True], steps[False], strict=True):
        assert math.hypot(*one) == pytest.approx(math.hypot(*other))
        assert math.dist(one, other) > 0.1


def test_growth_measures_the_stretches_asked_for() -> None:
    laps = Laps(1, 9)
    seconds = (laps.second(t) for t in range(1, 13))
    early, late = growth.measure(laps.introductions(), seconds, [Span("a", 2, 6), Span("b", 8, 12)])
    assert min(early.mean_ms, late.mean_ms) > 0.0
    assert 10.0 < early.memory_mib < 10_000.0
    assert "b takes at most 1.1 times a" in growth.report([early, late])


def test_unknown_tables_are_refused_with_those_there_are() -> None:
    with pytest.raises(CommandRefused, match=r"no table 'nothing'; there are same-graph, growth"):
        run(["nothing"], Path())
