"""The tracker against iSAM2 on the same readings: time and error side by side."""

import math
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

from backend.bench.accuracy.cases import Case, case_of, is_simulated
from backend.bench.accuracy.judge import judge
from backend.bench.speed.contestants import rivals, warm
from backend.bench.speed.figures import figures_of
from backend.bench.speed.race import Run, race
from backend.bench.speed.text import Row, bar, number, table
from estimator.measurements import AnyReading

CASES = ("plaza1", "paper-a", "shared-breadcrumbs")
SEEDS = 3
"""Of each scenario: their times are pooled, their errors averaged."""

HALF = 0.5
EQUAL_M = 0.005
"""RMSEs that agree to the centimetre shown are equal."""

HEAD = """\
same graph: fold and estimates with covariances each second, against iSAM2 on the same readings, in turns
iSAM2 has a pose (3 states) each second, in the plane; RSSI reaches it as a range by a fixed law
ratio: firethread's mean time over that of the row; growth: last quarter's mean over the first one's"""


class Pooled(NamedTuple):
    """One contestant over all seeds of a case.

    Attributes:
        name: its name.
        runs: one a seed.
        rmse_m: mean over the seeds (m); NaN where a run failed.
    """

    name: str
    runs: list[Run]
    rmse_m: float


def run(data: Path, names: Sequence[str] = CASES) -> None:
    """Measure, and print a table a case.

    Args:
        data: the folder that holds the data sets' folders.
        names: the cases.
    """
    warm()
    print(HEAD)
    for name in names:
        cases = [case_of(name, seed, data) for seed in range(SEEDS if is_simulated(name) else 1)]
        print(report(name, pooled(cases)), flush=True)


def keyframes(case: Case) -> list[list[AnyReading]]:
    """The readings in order of epoch, a list for each second in which there is any."""
    readings = sorted((report.reading for report in case.reports), key=lambda reading: reading.t)
    return [list(second) for _, second in groupby(readings, key=lambda reading: math.ceil(reading.t))]


def pooled(cases: Sequence[Case]) -> list[Pooled]:
    """All contestants on one case."""
    by_seed = [race(keyframes(case), rivals()) for case in cases]
    found = []
    for runs in zip(*by_seed, strict=True):
        errors = [_rmse_m(one, case) for one, case in zip(runs, cases, strict=True)]
        found.append(Pooled(runs[0].contestant.name, list(runs), sum(errors) / len(errors)))
    return found


def report(name: str, contestants: Sequence[Pooled]) -> str:
    """The table of one case, and its bars."""
    ours = contestants[0]
    mean_ms = figures_of(*_times(ours, whole=True)).mean_ms
    rows, bars = [], []
    for one in contestants:
        for whole in (True,) if one is ours else (False, True):
            figures = figures_of(*_times(one, whole)) if any(run.spent for run in one.runs) else None
            ratio = math.nan if one is ours or figures is None else mean_ms / figures.mean_ms
            label = f"{one.name}{' + covariances' if whole and one is not ours else ''}"
            failures = [run.failed for run in one.runs if run.failed is not None]
            rows.append(Row(label, figures, ratio, (number(one.rmse_m, 2),), "; ".join(failures)))
            if not math.isnan(ratio):
                bars.append(_bar(label, ratio, ours.rmse_m, one.rmse_m))
    seconds, readings = sum(len(run.spent) for run in ours.runs), sum(run.readings for run in ours.runs)
    title = f"{name}: {seconds} keyframes, {readings} readings"
    return "\n".join([table(title, rows, ("RMSE m",)), *bars])


def _bar(rival: str, ratio: float, ours_m: float, rival_m: float) -> str:
    """Half the mean time, at equal or better accuracy; a rival that failed is no measure of accuracy."""
    if math.isnan(rival_m):
        return bar(f"at most {HALF:g} of {rival}, which failed: {ratio:.2f}", ratio <= HALF)
    accurate = ours_m <= rival_m + EQUAL_M
    words = f"at most {HALF:g} of {rival}, RMSE not above its: {ratio:.2f}, {ours_m:.2f} m to {rival_m:.2f} m"
    return bar(words, ratio <= HALF and accurate)


def _times(one: Pooled, whole: bool) -> tuple[list[float], int]:
    """The times of all seeds, second by second: quarters are quarters of each run; and the readings."""
    longest = max(len(run.spent) for run in one.runs)
    in_turns = [run.spent[i] for i in range(longest) for run in one.runs if i < len(run.spent)]
    times = [spent.whole_s if whole else spent.estimates_s for spent in in_turns]
    return times, sum(run.readings for run in one.runs)


def _rmse_m(run: Run, case: Case) -> float:
    if run.failed is not None:
        return math.nan
    return judge(run.contestant.tracks, case.truth, heights=False).errors.rmse_m
