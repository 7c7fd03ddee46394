"""A large incident as it happens: which share of one core the tracker takes."""

from typing import NamedTuple

from backend.bench.accuracy.judge import judge
from backend.bench.speed.contestants import Ours, warm
from backend.bench.speed.figures import figures_of
from backend.bench.speed.laps import Laps
from backend.bench.speed.race import Run, race
from backend.bench.speed.text import Row, bar, number, table

INCIDENT = Laps(responders=20, breadcrumbs=200, heard=10, sweeps=5)
DURATION_S = 120
MOST = 0.5
LONGEST_S = 600.0


class Load(NamedTuple):
    """How busy the tracker was.

    Attributes:
        share: processor time over the incident's own time.
        longest_ms: the slowest keyframe (ms).
    """

    share: float
    longest_ms: float


def run(laps: Laps = INCIDENT, duration_s: int = DURATION_S) -> None:
    """Measure, and print the table.

    Args:
        laps: the incident.
        duration_s: how long it lasts (s).
    """
    warm()
    a_second = laps.responders * laps.heard * laps.sweeps
    print(
        f"real time: {laps.responders} responders, {laps.breadcrumbs} breadcrumbs, {a_second} RSSI a second, "
        f"displacement 1 Hz, {duration_s} s"
    )
    seconds = (laps.second(second) for second in range(1, duration_s + 1))
    [taken] = race(seconds, [Ours()], laps.introductions(), LONGEST_S)
    rmse_m = judge(taken.contestant.tracks, laps.truth(duration_s), heights=False).errors.rmse_m
    figures = figures_of([spent.whole_s for spent in taken.spent], taken.readings)
    row = Row(taken.contestant.name, figures, more=(number(rmse_m, 2),), remark=taken.failed or "")
    print(table("estimates each second", [row], ("RMSE m",)))
    load = load_of(taken)
    print(f"share of one core: {load.share:.2f}; slowest keyframe {load.longest_ms:.0f} ms")
    print(bar(f"at most {MOST:g} of one core", load.share <= MOST and taken.failed is None), flush=True)


def load_of(taken: Run) -> Load:
    """How busy the tracker was in seconds that follow each other."""
    times = [spent.whole_s for spent in taken.spent]
    return Load(sum(times) / len(times), 1e3 * max(times))
