import math

import pytest

from backend.bench.speed.figures import Spent, figures_of
from backend.bench.speed.growth import Measured, Span, spans
from backend.bench.speed.growth import report as growth_report
from backend.bench.speed.race import Run
from backend.bench.speed.real_time import load_of
from backend.bench.speed.same_graph import Pooled, report
from backend.bench.speed.text import COLUMNS, Row, cells
from estimator.measurements import AnyReading


class Absent:
    """A contestant that takes nothing."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.tracks: dict[str, list[object]] = {}

    def take(self, readings: list[AnyReading]) -> Spent:
        raise NotImplementedError


def ran(name: str, whole_ms: list[float], rmse_m: float, failed: str | None = None) -> Pooled:
    """A contestant of whom the estimates alone take half as long."""
    spent = [Spent(0.0005 * ms, 0.001 * ms) for ms in whole_ms]
    return Pooled(name, [Run(Absent(name), spent, 10, failed)], rmse_m)  # type: ignore[arg-type]


def line_of(table: str, name: str) -> list[str]:
    """The cells of the line with that name."""
    [line] = [line for line in table.splitlines() if line.startswith(f"  {name}  ")]
    return line.removeprefix(f"  {name}").split()


def test_figures_of_given_times() -> None:
    figures = figures_of([0.001, 0.002, 0.003, 0.004, 0.005, 0.006, 0.007, 0.012], 80)
    assert figures.mean_ms == pytest.approx(5.0)
    assert figures.median_ms == pytest.approx(4.5)
    assert figures.p99_ms == pytest.approx(11.65)
    assert (figures.first_ms, figures.last_ms) == pytest.approx((1.5, 9.5))
    assert figures.growth == pytest.approx(9.5 / 1.5)
    assert figures.reading_us == pytest.approx(500.0)
    with pytest.raises(ValueError, match="no time"):
        figures_of([], 0)


def test_a_row_without_figures_has_dashes() -> None:
    assert cells(Row("nobody", None)) == ["–"] * len(COLUMNS)
    assert cells(Row("ours", figures_of([0.001], 1)))[-1] == "–"


def test_the_table_holds_the_ratios_of_the_given_times() -> None:
    told = report(
        "there", [ran("ours", [1.0, 3.0, 2.0, 2.0], 0.5), ran("theirs", [8.0, 10.0, 10.0, 12.0], 0.5)]
    )
    assert line_of(told, "ours")[-2:] == ["–", "0.50"]
    assert line_of(told, "theirs")[-2:] == ["0.40", "0.50"]
    assert line_of(told, "theirs + covariances")[-2:] == ["0.20", "0.50"]
    assert line_of(told, "theirs + covariances")[5] == "1.50"
    assert [line.rsplit(": ", 1)[1] for line in told.splitlines() if line.startswith("bar")] == ["met"] * 2


@pytest.mark.parametrize(("ours_ms", "ours_m"), [(2.0, 0.7), (6.0, 0.5)])
def test_slower_or_worse_is_not_met(ours_ms: float, ours_m: float) -> None:
    told = report("there", [ran("ours", [ours_ms], ours_m), ran("theirs", [10.0], 0.6)])
    assert told.splitlines()[-1].endswith("NOT met")


def test_a_rival_that_failed_is_judged_by_its_time_and_says_why() -> None:
    told = report("there", [ran("ours", [2.0], 0.5), ran("theirs", [10.0], math.nan, "lost its way")])
    assert "lost its way" in told
    assert told.splitlines()[-1] == "bar: at most 0.5 of theirs + covariances, which failed: 0.20: met"


def test_growth_compares_the_last_stretch_with_those_before() -> None:
    minute, quarter, hour = spans(2.0)
    assert hour == Span("hour 2", 3600.0, 7200.0)
    told = growth_report(
        [Measured(minute, 2.0, 100.0), Measured(quarter, 4.0, 111.0), Measured(hour, 4.2, 112.0)]
    )
    assert "minute 2            2.00        2.10     100.0        12.0" in told
    bars = [line.rsplit(": ", 1)[1] for line in told.splitlines() if line.startswith("bar")]
    assert bars == ["met", "met"]
    told = growth_report([Measured(quarter, 2.0, 100.0), Measured(hour, 2.3, 111.0)])
    assert told.count("NOT met") == 2


def test_the_share_of_a_core_is_work_over_seconds() -> None:
    [run] = ran("ours", [100.0, 300.0], 0.5).runs
    load = load_of(run)
    assert (load.share, load.longest_ms) == pytest.approx((0.2, 300.0))
