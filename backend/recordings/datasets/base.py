"""What converters share: readings in order of time become lines of a recorded log."""

import csv
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TextIO

import msgspec

from backend.errors import CommandRefused, in_reach
from estimator.measurements import AnyReading, Imu

Vector3 = tuple[float, float, float]
BATCH_S = 1.0
KNOWN_SIGMA_M = 0.05
"""How well a position that the data set gives was surveyed, where it does not say."""


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


def rows(path: Path) -> Iterator[dict[str, str]]:
    """The rows of a CSV file with a header.

    Raises:
        NotTheDataSet: there is no such file.
    """
    with opened(path) as file:
        yield from csv.DictReader(file)


def numbers(path: Path) -> list[dict[str, float]]:
    """The rows of a CSV file with a header and nothing but numbers.

    Raises:
        NotTheDataSet: there is no such file.
    """
    return [{name: float(word) for name, word in row.items()} for row in rows(path)]


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
        CommandRefused: it cannot be read.
    """
    if not path.is_file():
        raise NotTheDataSet(f"{path} is missing: give the folder that holds {path.name}")
    with in_reach(path):
        return path.open(encoding="utf-8", newline="")
