"""How the time of a keyframe grows with the crew among many breadcrumbs; iSAM2 beside small crews."""

import math
from collections.abc import Sequence

from backend.bench.accuracy.judge import judge
from backend.bench.speed.contestants import Contestant, Isam, Ours, warm
from backend.bench.speed.figures import figures_of
from backend.bench.speed.laps import Laps
from backend.bench.speed.race import Run, race
from backend.bench.speed.text import Row, number, table

CREWS = (1, 5, 20, 50)
BREADCRUMBS = 300
DURATION_S = 60
RIVALS_UNTIL = 5
SKIP = 10
RIVAL_S = 60.0
OURS_S = 600.0
HEAD = f"size: displacement 1 Hz and RSSI of the nearest 6 of {BREADCRUMBS} breadcrumbs each, {DURATION_S} s"


def run(crews: Sequence[int] = CREWS, breadcrumbs: int = BREADCRUMBS, duration_s: int = DURATION_S) -> None:
    """Measure, and print a table a crew.

    Args:
        crews: how many responders.
        breadcrumbs: how many lie there.
        duration_s: how long they walk (s).
    """
    warm()
    print(HEAD)
    for responders in crews:
        laps = Laps(responders, breadcrumbs)
        print(report(laps, runs_of(laps, duration_s), duration_s), flush=True)


def runs_of(laps: Laps, duration_s: int) -> list[Run]:
    """The tracker on its own or, in a small crew, beside iSAM2; placing everybody is not timed."""
    seconds = [laps.second(second) for second in range(1, duration_s + 1)]
    contestants: list[Contestant] = [Ours()]
    if laps.responders <= RIVALS_UNTIL:
        contestants.append(Isam(SKIP))
    return race(seconds, contestants, laps.introductions(), RIVAL_S if len(contestants) > 1 else OURS_S)


def report(laps: Laps, runs: Sequence[Run], duration_s: int) -> str:
    """The table of one crew."""
    truth = laps.truth(duration_s)
    ours = figures_of([spent.whole_s for spent in runs[0].spent], runs[0].readings)
    rows = []
    for run in runs:
        rival = run is not runs[0]
        figures = figures_of([spent.whole_s for spent in run.spent], run.readings) if run.spent else None
        ratio = ours.mean_ms / figures.mean_ms if rival and figures is not None else math.nan
        rmse_m = judge(run.contestant.tracks, truth, heights=False).errors.rmse_m
        label = f"{run.contestant.name}{' + covariances' if rival else ''}"
        rows.append(Row(label, figures, ratio, (number(rmse_m, 2),), run.failed or ""))
    return table(f"{laps.responders} responders", rows, ("RMSE m",))
