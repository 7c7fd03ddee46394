"""Outcomes of single runs, and the rows of a table: their means over the seeds."""

from collections.abc import Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np

from backend.bench.accuracy.judge import Verdict
from estimator.evaluate import Errors
from estimator.graph.dense import Array


class Outcome(NamedTuple):
    """One entrant on one case and seed.

    Attributes:
        case: its name.
        seed: of the scenario.
        entrant: its name.
        mode: `online` or `smoothed`.
        seconds: what it took (s).
        verdict: None if it failed.
        failed: why it failed.
    """

    case: str
    seed: int
    entrant: str
    mode: str
    seconds: float = 0.0
    verdict: Verdict | None = None
    failed: str | None = None


class Row(NamedTuple):
    """One entrant on one case, over all seeds.

    Attributes:
        case: its name.
        entrant: its name.
        mode: `online` or `smoothed`.
        errors: means over the seeds that came to an end; None if none did.
        unsure: standard errors of these means, by how the seeds differ; NaN where there are not two.
        shown: mean share of the responders' seconds with an estimate.
        seconds: mean of what a seed took (s).
        runs: so many seeds.
        failures: why seeds failed, one entry each.
    """

    case: str
    entrant: str
    mode: str
    errors: Errors | None
    unsure: Errors | None
    shown: float
    seconds: float
    runs: int
    failures: tuple[str, ...]


ABSENT = "does not take part"
"""Why there is no row for an entrant that is not made for such readings."""


def rows_of(outcomes: Sequence[Outcome]) -> list[Row]:
    """The rows of one case: online ones first, each mode in the order of the entrants."""
    order = list(dict.fromkeys((o.mode, o.entrant) for o in outcomes))
    order.sort(key=lambda one: one[0] != "online")
    by_entrant = sorted(outcomes, key=lambda o: order.index((o.mode, o.entrant)))
    rows = []
    for (mode, entrant), runs in groupby(by_entrant, key=lambda o: (o.mode, o.entrant)):
        own = [run for run in runs if run.failed != ABSENT]
        if own:
            rows.append(_row(own[0].case, entrant, mode, own))
    return rows


def _row(case: str, entrant: str, mode: str, runs: Sequence[Outcome]) -> Row:
    failures = tuple(f"seed {run.seed}: {run.failed}" for run in runs if run.failed is not None)
    done = [run for run in runs if run.verdict is not None]
    if not done:
        return Row(case, entrant, mode, None, None, 0.0, 0.0, len(runs), failures)
    table = np.array([run.verdict.errors for run in done if run.verdict is not None])
    shown = float(np.mean([run.verdict.shown for run in done if run.verdict is not None]))
    seconds = float(np.mean([run.seconds for run in done]))
    means, unsure = Errors(*table.mean(axis=0).tolist()), Errors(*_standard_errors(table).tolist())
    return Row(case, entrant, mode, means, unsure, shown, seconds, len(runs), failures)


def _standard_errors(table: Array) -> Array:
    """Of the means of a table's columns, seeds × n: all points of a seed share how its map is turned."""
    seeds, columns = table.shape
    if seeds < 2:
        return np.full(columns, np.nan)
    errors: Array = table.std(axis=0, ddof=1) / np.sqrt(seeds)
    return errors
