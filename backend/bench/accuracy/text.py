"""The tables as text; the report shows the same cells."""

import math
from collections.abc import Sequence

from backend.bench.accuracy.outcome import Row

COLUMNS = (
    *("RMSE m", "mean m", "max m", "mean %", "max %", "aligned m"),
    *("CE95 m", "VE95 m", "95 % in", "NEES", "elsewhere", "shown", "took s"),
)
NONE = "–"
WIDE = 12


def head(seeds: int, left_out: Sequence[str]) -> str:
    """What the tables mean, and what they leave out.

    Args:
        seeds: of each scenario.
        left_out: a line for each data set that is not judged.
    """
    lines = [
        f"scenarios: means over {seeds} seed{'s' if seeds != 1 else ''}; errors of all responders pooled",
        "online: each point from what was posted until it was shown; smoothed: from everything",
        "%: of the way walked; aligned: RMSE after the best rigid motion; 95 % in: % of the truth inside the",
        "95 % ellipse; NEES: per degree of freedom, 1 is honest; elsewhere: % of points that are 2 m off and",
        "outside the 99.9 % ellipse: surely shown elsewhere; shown: share of seconds with an estimate",
        "±: standard error by how the seeds differ: all points of a seed share how its map is turned",
        *(f"left out: {line}" for line in left_out),
    ]
    return "\n".join(lines)


def cells(row: Row) -> list[str]:
    """A row's figures, as `COLUMNS` names them; empty if every seed failed."""
    if row.errors is None or row.unsure is None:
        return []
    e, unsure = row.errors, row.unsure
    metres = (
        e.rmse_m,
        e.mean_m,
        e.max_m,
        e.mean_percent,
        e.max_percent,
        e.aligned_rmse_m,
        e.ce95_m,
        e.ve95_m,
    )
    return [
        *(_number(value, 2) for value in metres),
        _unsure(100.0 * e.coverage, 100.0 * unsure.coverage, 0),
        _unsure(e.nees, unsure.nees, 2),
        _unsure(100.0 * e.misleading, 100.0 * unsure.misleading, 2),
        _number(100.0 * row.shown, 0) + " %",
        _number(row.seconds, 1),
    ]


def failures(row: Row) -> str:
    """How many seeds failed, and why the first one did; empty if none."""
    if not row.failures:
        return ""
    return f"{len(row.failures)} of {row.runs} failed, {row.failures[0]}"


def table(case: str, rows: Sequence[Row]) -> str:
    """The table of one case."""
    wide = max([len(row.entrant) for row in rows], default=0) + 11
    lines = ["", f"{case:<{wide}}" + "".join(f"{name:>{WIDE}}" for name in COLUMNS)]
    if not rows:
        lines.append("  nobody takes part")
    for row in rows:
        name = f"  {row.mode:<9}{row.entrant}"
        line = f"{name:<{wide}}" + "".join(f"{cell:>{WIDE}}" for cell in cells(row))
        lines.append(f"{line}  {failures(row)}".rstrip())
    return "\n".join(lines)


def _unsure(value: float, error: float, digits: int) -> str:
    """A mean with its standard error, if there is one."""
    return _number(value, digits) + ("" if math.isnan(error) else f"±{error:.{digits}f}")


def _number(value: float, digits: int) -> str:
    return NONE if math.isnan(value) else f"{value:.{digits}f}"
