"""What converters share: readings in order of time become lines of a recorded log."""

import csv
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO, TypeVar

import msgspec

from backend.errors import CommandRefused, in_reach
from estimator.measurements import AnyReading, Imu

Known = TypeVar("Known")
Vector3 = tuple[float, float, float]
BATCH_S = 1.0
KNOWN_SIGMA_M = 0.05
"""How well a position that the data set gives was surveyed, where it does not say."""
ANEW = "copy the data set anew from where it is published"


class NotTheDataSet(CommandRefused):
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


def samples(
    node: str,
    rate_hz: float,
    epochs: Sequence[float],
    forces: Sequence[Vector3],
    rates: Sequence[Vector3],
    fields: Sequence[Vector3] | None = None,
) -> Iterator[Imu]:
    """Samples of an inertial unit as readings of a second each.

    Args:
        node: the unit.
        rate_hz: samples a second.
        epochs: of the samples, n (s).
        forces: specific force, n × 3 (m/s²).
        rates: angular rate, n × 3 (rad/s).
        fields: magnetic flux density, n × 3 (µT).
    """
    together = round(BATCH_S * rate_hz)
    for first in range(0, len(epochs), together):
        some = slice(first, first + together)
        yield Imu(
            t=epochs[first],
            node=node,
            rate_hz=rate_hz,
            accel_mps2=list(forces[some]),
            gyro_radps=list(rates[some]),
            mag_ut=None if fields is None else list(fields[some]),
        )


def _line(gateway: str, number: int, readings: list[AnyReading]) -> bytes:
    sent = max(reading.until_t for reading in readings)
    return msgspec.json.encode(_Line(gateway, f"{gateway}-{number:06d}", sent, readings)) + b"\n"


class Row:
    """A row of a file, which says where it stands when it does not hold what it must.

    Args:
        where: the file and the line.
        fields: by the name of the column, or its number from 0.
    """

    def __init__(self, where: str, fields: Mapping[str | int, str | None]) -> None:
        self._where = where
        self._fields = fields

    def word(self, column: str | int) -> str:
        """What stands in a column.

        Raises:
            NotTheDataSet: there is no such column, or the row ends before it.
        """
        word = self._fields.get(column)
        if word is None:
            raise NotTheDataSet(f"{self._where}: column {column} is missing: {ANEW}")
        return word

    def number(self, column: str | int) -> float:
        """The number in a column.

        Raises:
            NotTheDataSet: there is none, or none that is finite.
        """
        word = self.word(column)
        try:
            number = float(word)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise NotTheDataSet(f"{self._where}: column {column} is {word!r}, and not a number: {ANEW}")
        return number

    def above_0(self, column: str | int) -> float:
        """The number in a column, which is above 0.

        Raises:
            NotTheDataSet: it is not.
        """
        number = self.number(column)
        if number <= 0.0:
            raise NotTheDataSet(f"{self._where}: column {column} is {number:g}, and not above 0: {ANEW}")
        return number

    def one_of(self, known: Mapping[str, Known], column: str | int) -> Known:
        """What is known under the name in a column.

        Raises:
            NotTheDataSet: nothing is.
        """
        word = self.word(column)
        if word not in known:
            raise NotTheDataSet(f"{self._where}: column {column} is {word!r}, which nothing explains: {ANEW}")
        return known[word]

    def whole(self, column: str | int) -> int:
        """The whole number in a column, however large.

        Raises:
            NotTheDataSet: there is none.
        """
        word = self.word(column)
        try:
            return int(word)
        except ValueError as error:
            refused = f"{self._where}: column {column} is {word!r}, and not a whole number: {ANEW}"
            raise NotTheDataSet(refused) from error


def rows(path: Path) -> Iterator[Row]:
    """The rows of a CSV file with a header.

    Raises:
        NotTheDataSet: there is no such file, or none with rows.
    """
    with opened(path) as file, _as_text(path):
        line = None
        for line in (table := csv.DictReader(file)):
            yield Row(f"{path}, line {table.line_num}", line)
    if line is None:
        raise _nothing_in(path)


def numbers(path: Path, columns: Sequence[str]) -> list[dict[str, float]]:
    """Columns of a CSV file with a header.

    Args:
        path: of the file.
        columns: their names.

    Raises:
        NotTheDataSet: there is no such file, or none with rows, or one of them lacks a number.
    """
    return [{name: row.number(name) for name in columns} for row in rows(path)]


def words(path: Path) -> Iterator[Row]:
    """The lines of a text file that are not empty, their words as columns.

    Raises:
        NotTheDataSet: there is no such file, or nothing in it.
    """
    found = False
    with opened(path) as file, _as_text(path):
        for number, line in enumerate(file, start=1):
            if line.strip():
                found = True
                yield Row(f"{path}, line {number}", dict(enumerate(line.split())))
    if not found:
        raise _nothing_in(path)


def text_of(path: Path) -> str:
    """All of a text file.

    Raises:
        NotTheDataSet: there is no such file, or it is none of text.
    """
    with opened(path) as file, _as_text(path):
        return file.read()


@contextmanager
def _as_text(path: Path) -> Iterator[None]:
    try:
        yield
    except (UnicodeDecodeError, csv.Error) as error:
        raise NotTheDataSet(f"{path} is no text with columns ({error}): {ANEW}") from error


def _nothing_in(path: Path) -> NotTheDataSet:
    return NotTheDataSet(f"{path} holds no rows: {ANEW}")


def opened(path: Path) -> TextIO:
    """`path`, opened for reading.

    Raises:
        NotTheDataSet: there is no such file.
        CommandRefused: it cannot be read.
    """
    if not path.is_file():
        raise NotTheDataSet(f"{path} is missing: give the folder that holds {path.name}")
    with in_reach(path):
        return path.open(encoding="utf-8", newline="")
