"""Hours of work: whether a keyframe costs more in hour 2 than in minute 2, in time and in memory."""

import gc
import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from backend.bench.speed.contestants import warm
from backend.bench.speed.figures import MS
from backend.bench.speed.laps import Laps
from backend.bench.speed.stopwatch import Stopwatch
from backend.bench.speed.text import bar
from estimator.measurements import AnyReading
from estimator.trackers.kirchhoff import KirchhoffTracker

HOURS = 2.0
WALK = Laps(responders=3, breadcrumbs=25, heard=3)
"""An endless walk: each minute is like the one before: only the tracker itself can make it slower."""

FLAT = 1.1
FLAT_MIB = 10.0
HEAD = """\
growth: {} responders walk laps among {} breadcrumbs; displacement 1 Hz, {} RSSI a second each
the window that is solved again grows until minute 6; from then on all has to stay as it is"""


class Span(NamedTuple):
    """A stretch of the run.

    Attributes:
        name: what it is called.
        from_s: where it begins (s).
        until_s: where it ends (s).
    """

    name: str
    from_s: float
    until_s: float


class Measured(NamedTuple):
    """What a stretch took.

    Attributes:
        span: the stretch.
        mean_ms: of a keyframe (ms).
        memory_mib: resident at its end (MiB).
    """

    span: Span
    mean_ms: float
    memory_mib: float


def spans(hours: float) -> list[Span]:
    """Minute 2; minute 15, when the tracker's window of 5 minutes is full; the last hour."""
    end_s = 3600.0 * hours
    return [
        Span("minute 2", 60.0, 120.0),
        Span("minute 15", 840.0, 900.0),
        Span(f"hour {hours:g}", end_s - 3600.0, end_s),
    ]


def run(hours: float = HOURS) -> None:
    """Measure, and print the table.

    Args:
        hours: how long the walk is; more than one.
    """
    warm()
    print(HEAD.format(WALK.responders, WALK.breadcrumbs, WALK.heard), flush=True)
    seconds = range(1, round(3600.0 * hours) + 1)
    print(report(measure(WALK.introductions(), (WALK.second(t) for t in seconds), spans(hours))), flush=True)


def measure(
    start: Sequence[AnyReading], seconds: Iterable[Sequence[AnyReading]], of: Sequence[Span]
) -> list[Measured]:
    """Let the tracker take a long walk.

    Args:
        start: the introductions.
        seconds: the readings of each second.
        of: the stretches that are told; each ends at another second.
    """
    tracker, times = KirchhoffTracker(), np.zeros(0)
    tracker.fold(start)
    memory: dict[float, float] = {}
    taken = []
    for second, spent_s in enumerate(_times(tracker, seconds), 1):
        taken.append(spent_s)
        if any(span.until_s == second for span in of):
            memory[second] = resident_mib()
    times = MS * np.array(taken)
    return [
        Measured(span, float(times[int(span.from_s) : int(span.until_s)].mean()), memory[span.until_s])
        for span in of
    ]


def report(measured: Sequence[Measured]) -> str:
    """The table, and its bars: the last stretch against the one before, when the window was full."""
    last = measured[-1]
    lines = [f"{'':14}{'mean ms':>10}{last.span.name + ' /':>12}{'MiB':>10}{last.span.name + ' −':>12}"]
    for one in measured:
        ratio, more_mib = last.mean_ms / one.mean_ms, last.memory_mib - one.memory_mib
        lines.append(
            f"{one.span.name:<14}{one.mean_ms:>10.2f}{ratio:>12.2f}{one.memory_mib:>10.1f}{more_mib:>12.1f}"
        )
    full = measured[-2]
    slower, larger = last.mean_ms / full.mean_ms, last.memory_mib - full.memory_mib
    words = f"{last.span.name} takes at most {FLAT:g} times {full.span.name}"
    lines.append(bar(words, slower <= FLAT))
    words = f"{last.span.name} holds at most {FLAT_MIB:g} MiB more than {full.span.name}"
    lines.append(bar(words, larger <= FLAT_MIB))
    return "\n".join(lines)


def resident_mib() -> float:
    """Memory of this process now, rubbish left out (MiB)."""
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2.0**20


def _times(tracker: KirchhoffTracker, seconds: Iterable[Sequence[AnyReading]]) -> Iterator[float]:
    for readings in seconds:
        watch = Stopwatch()
        with watch:
            tracker.fold(readings)
            tracker.estimates()
        yield watch.spent_s
