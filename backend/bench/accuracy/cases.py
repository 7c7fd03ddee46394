"""What is judged: simulated scenarios and public data sets, readings and truth kept apart."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import msgspec
import numpy as np

from backend.recordings import converter_names
from backend.recordings.datasets import convert
from backend.recordings.datasets.truth import truth_of
from estimator.measurements import AnyReading, Node
from estimator.simulate import Report, TrueTrack, scenario, scenario_names
from estimator.simulate.base import in_posting_order


class Case(NamedTuple):
    """One experiment.

    Attributes:
        name: a scenario, or `data set` or `data set:recording`.
        reports: readings in order of posting; this alone is what an entrant gets.
        truth: the true tracks of the responders that are judged, by node; for the judge only.
    """

    name: str
    reports: tuple[Report, ...]
    truth: dict[str, TrueTrack]


class _Line(msgspec.Struct):
    gateway: str
    readings: list[AnyReading]


_decode_line = msgspec.json.Decoder(_Line).decode


def names(data: Path) -> tuple[list[str], list[str]]:
    """The cases there are, scenarios first, and a line for each data set that is left out.

    Args:
        data: the folder that holds the data sets' folders.
    """
    found, left_out = scenario_names(), []
    for name in converter_names():
        folder = data / name.partition(":")[0]
        if not folder.is_dir():
            left_out.append(f"{name}: there is no folder {folder}")
        else:
            found.append(name)
    converted = {name.partition(":")[0] for name in converter_names()}
    folders = sorted(path.name for path in data.iterdir() if path.is_dir()) if data.is_dir() else []
    left_out += [f"{name}: has no converter" for name in folders if name not in converted]
    return found, left_out


def is_simulated(name: str) -> bool:
    """Whether a case is a scenario, which differs from seed to seed, rather than a recording."""
    return name in scenario_names()


def case_of(name: str, seed: int, data: Path) -> Case:
    """Build a case.

    Args:
        name: one of `names(data)[0]`.
        seed: of the scenario; without meaning for a data set.
        data: the folder that holds the data sets' folders.

    Raises:
        KeyError: there is no such case.
        NotTheDataSet: a file is missing.
    """
    if is_simulated(name):
        built = scenario(name, seed)
        return Case(name, built.reports, _judged(built.reports, built.truth))
    folder = data / name.partition(":")[0]
    reports = in_posting_order(list(_converted(name, folder)))
    tracks = {
        node: TrueTrack(t_s, position_m, np.zeros(len(t_s), dtype=np.int64), np.zeros(len(t_s)))
        for node, (t_s, position_m) in truth_of(name, folder).items()
    }
    return Case(name, reports, _judged(reports, tracks))


def _converted(name: str, folder: Path) -> Iterator[Report]:
    """The data set's readings, posted as they are measured."""
    for line in convert(name, folder):
        batch = _decode_line(line)
        yield from (Report(reading, batch.gateway, reading.until_t) for reading in batch.readings)


def _judged(reports: tuple[Report, ...], truth: dict[str, TrueTrack]) -> dict[str, TrueTrack]:
    """Tracks of responders: the others stand, or are drones that know their own place."""
    roles = {r.reading.node: r.reading.role for r in reports if isinstance(r.reading, Node)}
    return {
        node: truth[node] for node, role in sorted(roles.items()) if role == "responder" and node in truth
    }
