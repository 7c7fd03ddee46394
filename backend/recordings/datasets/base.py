"""What converters share: readings in order of time become lines of a recorded log."""

import csv
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TextIO

import msgspec

from estimator.measurements import AnyReading

BATCH_S = 1.0
KNOWN_SIGMA_M = 0.05
"""How well a position that the data set gives was surveyed, where it does not say."""


class NotTheDataSet(Exception):  # noqa: N818 - names the condition
    """The folder does not hold what the converter reads."""


class _Line(msgspec.Struct, frozen=True):
    gateway: str
    batch: str
    sent: float
    readings: list[AnyReading]


def lines(gateway: str, readings: Iterable[AnyReading]) -> Iterator[bytes]:
    """The lines, newline included: batches of a second of readings, each as a gateway would post it.

    Args:
        gateway: who posts them.
        readings: in any order; they are sorted by epoch, equal ones keep their order.
    """
    gathered: list[AnyReading] = []
    number = 0
    for reading in sorted(readings, key=lambda reading: reading.t):
        if gathered and reading.t >= gathered[0].t + BATCH_S:
            yield _line(gateway, number, gathered)
            gathered, number = [], number + 1
        gathered.append(reading)
    if gathered:
        yield _line(gateway, number, gathered)


def _line(gateway: str, number: int, readings: list[AnyReading]) -> bytes:
    return msgspec.json.encode(_Line(gateway, f"{gateway}-{number:06d}", readings[-1].t, readings)) + b"\n"


def rows(path: Path) -> Iterator[dict[str, str]]:
    """The rows of a CSV file with a header.

    Raises:
        NotTheDataSet: there is no such file.
    """
    with opened(path) as file:
        yield from csv.DictReader(file)


def words(path: Path) -> Iterator[list[str]]:
    """The words of each line of a text file.

    Raises:
        NotTheDataSet: there is no such file.
    """
    with opened(path) as file:
        for line in file:
            if line.strip():
                yield line.split()


def opened(path: Path) -> TextIO:
    """`path`, opened for reading.

    Raises:
        NotTheDataSet: there is no such file.
    """
    if not path.is_file():
        raise NotTheDataSet(f"{path} is missing: give the folder that holds {path.name}")
    return path.open(encoding="utf-8", newline="")
