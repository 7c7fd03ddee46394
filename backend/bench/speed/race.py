"""Contestants take the same seconds in turns, so that what slows the machine slows all of them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from backend.bench.speed.contestants import Contestant
from backend.bench.speed.figures import Spent
from estimator.measurements import AnyReading

LONGEST_S = 60.0
"""Enough for minutes of work that take a minute; iSAM2 may grow without bound."""


@dataclass
class Run:
    """How one contestant came through.

    Attributes:
        contestant: who.
        spent: what each second took that it came through.
        readings: so many it took in.
        failed: why it did not come to the end; None: it did.
    """

    contestant: Contestant
    spent: list[Spent] = field(default_factory=list)
    readings: int = 0
    failed: str | None = None


def race(
    seconds: Iterable[Sequence[AnyReading]],
    contestants: Sequence[Contestant],
    start: Sequence[AnyReading] = (),
    longest_s: float = LONGEST_S,
) -> list[Run]:
    """Let all contestants take each second before any takes the next.

    Args:
        seconds: the readings of each.
        contestants: in this order; it turns round each second, so that none always comes first.
        start: taken before, and not timed.
        longest_s: processor time after which a contestant has to stop (s).
    """
    runs = [Run(contestant) for contestant in contestants]
    for run in runs:
        if start:
            run.contestant.take(start)
    for number, readings in enumerate(seconds):
        order = runs if number % 2 == 0 else runs[::-1]
        for run in order:
            if run.failed is None:
                _take(run, readings, longest_s)
    return runs


def _take(run: Run, readings: Sequence[AnyReading], longest_s: float) -> None:
    try:
        run.spent.append(run.contestant.take(readings))
    except RuntimeError as error:
        run.failed = " ".join(str(error).split())[:120] or type(error).__name__
        return
    run.readings += len(readings)
    if sum(spent.whole_s for spent in run.spent) > longest_s:
        run.failed = f"stopped in second {len(run.spent)}, after {longest_s:g} s of work"
