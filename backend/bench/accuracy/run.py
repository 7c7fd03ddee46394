"""`firethread bench accuracy`: every entrant on every case and seed, in a fixed order."""

import time
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import lru_cache
from itertools import groupby
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

import numpy as np

from backend.bench.accuracy import text
from backend.bench.accuracy.cases import Case, case_of, is_simulated, names
from backend.bench.accuracy.entrants import Entrant, entrants
from backend.bench.accuracy.gtsam_factors import GtsamMissing
from backend.bench.accuracy.html import page
from backend.bench.accuracy.judge import judge
from backend.bench.accuracy.outcome import ABSENT, Outcome, Row, rows_of
from backend.errors import CommandRefused, in_reach


class Choice(NamedTuple):
    """What is asked for.

    Attributes:
        seeds: so many of each scenario, from 0.
        only: cases, or data sets with all their recordings; none: all.
        trackers: entrants; none: all.
        data: the folder that holds the data sets' folders.
        html: file of the report, if one is wanted.
        jobs: so many processes.
    """

    seeds: int = 20
    only: Sequence[str] = ()
    trackers: Sequence[str] = ()
    data: Path = Path("../shared/data")
    html: Path | None = None
    jobs: int = 1


class Task(NamedTuple):
    """One entrant on one case: small, so that it is quick to hand to a process.

    Attributes:
        case: its name.
        seed: of the scenario.
        data: the folder that holds the data sets' folders.
        entrant: its name.
        mode: `online` or `smoothed`.
    """

    case: str
    seed: int
    data: Path
    entrant: str
    mode: str


def run(choice: Choice) -> None:
    """Measure, print the tables as they are ready, and write the report.

    Raises:
        CommandRefused: a case or an entrant is not known, or GTSAM is asked for by name and not installed.
    """
    cases, left_out = _cases(choice)
    competing = _entrants(choice.trackers)
    print(text.head(choice.seeds, left_out), flush=True)
    tasks = [
        Task(case, seed, choice.data, entrant.name, entrant.mode)
        for case in cases
        for seed in range(choice.seeds if is_simulated(case) else 1)
        for entrant in competing
    ]
    rows: list[Row] = []
    drawn: list[Outcome] = []
    for case, outcomes in groupby(_outcomes(tasks, choice.jobs), key=lambda outcome: outcome.case):
        all_of_it = list(outcomes)
        of_case = rows_of(all_of_it)
        rows += of_case
        drawn += [outcome for outcome in all_of_it if outcome.seed == 0]
        print(text.table(case, of_case), flush=True)
    if choice.html is not None:
        with in_reach(choice.html):
            choice.html.write_text(page(rows, drawn, choice.seeds, left_out), encoding="utf-8")
        print(f"report: {choice.html}")


def perform(task: Task) -> Outcome:
    """Let one entrant track one case, and judge it."""
    case = _case(task.case, task.seed, task.data)
    entrant = next(e for e in entrants() if (e.name, e.mode) == (task.entrant, task.mode))
    return outcome_of(case, task.seed, entrant)


def outcome_of(case: Case, seed: int, entrant: Entrant) -> Outcome:
    """What comes of an entrant that is given a case's readings; its failure is an outcome as well.

    Args:
        case: readings and truth.
        seed: which of the scenario's.
        entrant: gets the readings only.
    """
    outcome = Outcome(case.name, seed, entrant.name, entrant.mode)
    if not entrant.takes(case.reports):
        return outcome._replace(failed=ABSENT)
    start = time.perf_counter()
    try:
        tracks = entrant.track(case.reports)
    except (RuntimeError, np.linalg.LinAlgError, GtsamMissing) as error:
        reason = " ".join(str(error).split())
        return outcome._replace(failed=reason[:200] or type(error).__name__)
    seconds = time.perf_counter() - start
    try:
        verdict = judge(tracks, case.truth, entrant.heights)
    except ValueError as error:
        return outcome._replace(failed=str(error))
    if seed:
        verdict = verdict._replace(drawn=())  # only the first seed is drawn
    return outcome._replace(seconds=seconds, verdict=verdict)


@lru_cache(maxsize=1)
def _case(name: str, seed: int, data: Path) -> Case:
    return case_of(name, seed, data)


def _outcomes(tasks: Iterable[Task], jobs: int) -> Iterator[Outcome]:
    """The outcomes in the order of the tasks."""
    if jobs <= 1:
        yield from map(perform, tasks)
        return
    # Spawned, not forked: a process that GTSAM's threads have been in must not be copied.
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        yield from pool.map(perform, tasks)


def _cases(choice: Choice) -> tuple[list[str], list[str]]:
    found, left_out = names(choice.data)
    if not choice.only:
        return found, left_out
    for name in choice.only:
        if not any(name in (case, case.partition(":")[0]) for case in found):
            raise CommandRefused(f"no case {name!r}; there are {', '.join(found)}")
    chosen = set(choice.only)
    return [case for case in found if chosen & {case, case.partition(":")[0]}], []


def _entrants(chosen: Sequence[str]) -> list[Entrant]:
    found = entrants()
    known = dict.fromkeys(entrant.name for entrant in found)
    for name in chosen:
        if name not in known:
            raise CommandRefused(f"no entrant {name!r}; there are {', '.join(known)}")
    return [entrant for entrant in found if not chosen or entrant.name in chosen]
