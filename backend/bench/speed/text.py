"""The tables as text."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from backend.bench.speed.figures import Figures

COLUMNS = ("median ms", "mean ms", "p99 ms", "1st quarter", "last", "growth", "µs/reading", "ratio")
WIDE = 34
NONE = "–"


class Row(NamedTuple):
    """One line of a table.

    Attributes:
        name: who, and what was timed.
        figures: None if there are none.
        ratio: the tracker's mean time over this one's; NaN: not compared.
        more: further cells.
        remark: at the end of the line.
    """

    name: str
    figures: Figures | None
    ratio: float = math.nan
    more: tuple[str, ...] = ()
    remark: str = ""


def table(title: str, rows: Sequence[Row], more: Sequence[str] = ()) -> str:
    """A table of times.

    Args:
        title: what was run.
        rows: its lines.
        more: names of the rows' further cells.
    """
    lines = ["", title, " " * WIDE + "".join(f"{name:>12}" for name in (*COLUMNS, *more))]
    for row in rows:
        line = f"  {row.name:<{WIDE - 2}}" + "".join(f"{cell:>12}" for cell in (*cells(row), *row.more))
        lines.append(f"{line}  {row.remark}".rstrip())
    return "\n".join(lines)


def cells(row: Row) -> list[str]:
    """A row's figures, as `COLUMNS` names them."""
    if row.figures is None:
        return [NONE] * len(COLUMNS)
    f = row.figures
    return [
        *(f"{value:.2f}" for value in (f.median_ms, f.mean_ms, f.p99_ms, f.first_ms, f.last_ms, f.growth)),
        f"{f.reading_us:.0f}",
        number(row.ratio, 2),
    ]


def number(value: float, digits: int) -> str:
    """A number, or a dash for none."""
    return NONE if math.isnan(value) else f"{value:.{digits}f}"


def bar(what: str, is_met: bool) -> str:
    """A bar, and whether it is met."""
    return f"bar: {what}: {'met' if is_met else 'NOT met'}"
