"""The whole incident solved again: how long who asks for the smoothed view waits for its solution.

What the server does besides, reading the log and encoding the tracks, takes some hundredths of it.
"""

import time
from collections.abc import Sequence
from typing import NamedTuple

from backend.bench.accuracy.judge import judge
from backend.bench.speed.contestants import warm
from backend.bench.speed.laps import Laps
from backend.bench.speed.text import bar
from backend.tracking.smoothing import AHEAD_EVERY_S
from estimator.estimate import TrackPoint
from estimator.trackers.base import Told, TrackerSettings
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.heard import Heard

INCIDENT = Laps(responders=10, breadcrumbs=40)
UNTOLD = INCIDENT._replace(told=False)
"""The same where nobody has told what the units face."""
DURATION_S = 1800
LONGEST_S = 5.0
TIMES = 2


class Taken(NamedTuple):
    """What solving it took.

    Attributes:
        readings: how many were solved.
        alone: the clock's seconds, each time, from the readings alone.
        running: while the incident runs: its server has folded the older ones ahead.
        rmse_m: horizontal (m).
    """

    readings: int
    alone: tuple[float, ...]
    running: tuple[float, ...]
    rmse_m: float


def measure(laps: Laps, duration_s: int) -> Taken:
    """Solve an incident several times, by the clock: somebody waits for it.

    Args:
        laps: the incident.
        duration_s: how long it has lasted (s).
    """
    readings = laps.introductions()
    for second in range(1, duration_s + 1):
        readings += laps.second(second)
    settings = TrackerSettings()
    heard = Heard(settings.lag_s, settings.origin_wgs84)
    heard.hear(readings)
    heard.fold_ahead(duration_s - AHEAD_EVERY_S)
    alone = [_solved(readings) for _ in range(TIMES)]
    running = [_solved(heard) for _ in range(TIMES)]
    found = judge(running[-1][1], laps.truth(duration_s), heights=False).errors
    return Taken(len(readings), tuple(s for s, _ in alone), tuple(s for s, _ in running), found.rmse_m)


def _solved(told: Told) -> tuple[float, dict[str, list[TrackPoint]]]:
    began_s = time.perf_counter()
    tracks = BatchSmoother(TrackerSettings()).smooth(told)
    return time.perf_counter() - began_s, tracks


def run(incidents: Sequence[Laps] = (INCIDENT, UNTOLD), duration_s: int = DURATION_S) -> None:
    """Measure, and print what it took.

    Args:
        incidents: what has happened.
        duration_s: how long each has lasted (s).
    """
    warm()
    for laps in incidents:
        measure(laps._replace(responders=2, breadcrumbs=9), 10)
        taken = measure(laps, duration_s)
        print(
            f"smoothed: {laps.responders} responders, {laps.breadcrumbs} breadcrumbs, {duration_s} s, "
            f"headings {'told' if laps.told else 'untold'}, {taken.readings} readings"
        )
        print(f"RMSE {taken.rmse_m:.2f} m")
        for what, seconds in (("while it runs", taken.running), ("from its log alone", taken.alone)):
            print(f"solved {what} in {', '.join(f'{each_s:.2f} s' for each_s in seconds)}")
            print(bar(f"within {LONGEST_S:g} s", max(seconds) <= LONGEST_S), flush=True)
