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
from estimator.trackers.base import TrackerSettings
from estimator.trackers.batch import BatchSmoother

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
        seconds: the clock's, each time (s).
        rmse_m: horizontal (m).
    """

    readings: int
    seconds: tuple[float, ...]
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
    seconds, tracks = [], {}
    for _ in range(TIMES):
        began_s = time.perf_counter()
        tracks = BatchSmoother(TrackerSettings()).smooth(readings)
        seconds.append(time.perf_counter() - began_s)
    found = judge(tracks, laps.truth(duration_s), heights=False).errors
    return Taken(len(readings), tuple(seconds), found.rmse_m)


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
        times = ", ".join(f"{seconds:.2f} s" for seconds in taken.seconds)
        print(f"solved in {times}; RMSE {taken.rmse_m:.2f} m")
        print(bar(f"within {LONGEST_S:g} s", max(taken.seconds) <= LONGEST_S), flush=True)
