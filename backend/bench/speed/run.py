"""`firethread bench speed`: the tables of the tracker's speed, one after the other."""

from collections.abc import Callable, Sequence
from pathlib import Path

from backend.bench.speed import growth, real_time, same_graph, size, smoothed
from backend.errors import CommandRefused

TABLES: dict[str, Callable[[Path], None]] = {
    "same-graph": same_graph.run,
    "growth": lambda _: growth.run(),
    "size": lambda _: size.run(),
    "real-time": lambda _: real_time.run(),
    "smoothed": lambda _: smoothed.run(),
}


def run(only: Sequence[str], data: Path) -> None:
    """Measure, and print the tables.

    Args:
        only: names of tables, or of cases of `same-graph`; none: all tables.
        data: the folder that holds the data sets' folders.

    Raises:
        CommandRefused: a name is not known, or GTSAM is not installed.
    """
    for name in only:
        if name not in TABLES and name not in same_graph.CASES:
            raise CommandRefused(f"no table {name!r}; there are {', '.join((*TABLES, *same_graph.CASES))}")
    cases = [name for name in same_graph.CASES if name in only]
    if cases and "same-graph" not in only:
        same_graph.run(data, cases)
        print()
    for name, table in TABLES.items():
        if not only or name in only:
            table(data)
            print()
