"""An exported file, read: what its first line says of its incident, and its lines as batches."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from backend.errors import NotUnderstood, TooLarge, in_reach
from backend.log.base import NewBatch
from backend.log.decode import judge
from backend.log.incident import Clock
from backend.log.lines import Line, parse_line
from backend.recordings.about import About, understood

MAX_READINGS = 10_000
"""The contract's limit of a batch: what was exported had passed it."""

Numbered = tuple[int, NewBatch]
"""A batch with the `seq` of its line in a file."""


def about_in(path: Path, said: str) -> About:
    """What the first line of a file says of its incident.

    Args:
        path: of the file.
        said: what the file is called when it is refused.

    Raises:
        NotUnderstood: the line is none of a log, or says what is out of bounds.
        CommandRefused: the file cannot be read.
    """
    for number, line in _lines(path, said):
        with _naming(said, number):
            return understood(line.incident)
    return understood(None)


def batches_in(path: Path, incident: str, clock: Clock, said: str) -> Iterator[Numbered]:
    """The lines of a file as batches of `incident`, each with its `seq` there; empty lines are left out.

    Args:
        path: of the file.
        incident: whose they become.
        clock: of the incident.
        said: what the file is called when one of its lines is refused.

    Raises:
        NotUnderstood: a line is no batch; the message names it.
        TooLarge: a line has more readings than a batch may have.
        CommandRefused: the file cannot be read.
    """
    for count, (number, line) in enumerate(_lines(path, said), start=1):
        if count > 1 and line.incident is not None:
            raise NotUnderstood(
                f"{said}, line {number}: another incident begins here, and each has a file of its own. "
                "Nothing was imported."
            )
        with _naming(said, number):
            batch = _new_batch(line, incident, clock)
        yield count if line.seq is None else line.seq, batch


def _lines(path: Path, said: str) -> Iterator[tuple[int, Line]]:
    """The lines that are not empty, with their numbers from 1."""
    with in_reach(said), path.open("rb") as file:
        for number, text in enumerate(file, start=1):
            if text.strip():
                with _naming(said, number):
                    line = parse_line(text)
                yield number, line


@contextmanager
def _naming(said: str, number: int) -> Iterator[None]:
    """What is refused is refused by the name of the file and the number of its line."""
    try:
        yield
    except (NotUnderstood, TooLarge) as error:
        why = error.detail.removesuffix(".")
        raise type(error)(f"{said}, line {number}: {why}. Nothing was imported.") from error


def _new_batch(line: Line, incident: str, clock: Clock) -> NewBatch:
    body = line.body()
    judged = judge(body, MAX_READINGS, line.received if clock == "live" else None)
    aside = {fault.index for fault in line.rejected}
    rejected = line.rejected + tuple(fault for fault in judged.rejected if fault.index not in aside)
    count = len(judged.accepted) + len(judged.rejected)
    newest = max((reading.until_t for reading in judged.accepted), default=0.0)
    received = line.received if line.received is not None else line.sent
    return NewBatch(
        incident=incident,
        gateway=line.gateway,
        batch=line.batch,
        received=newest if received is None else received,
        sent=line.sent,
        body=body,
        accepted=count - len(rejected),
        rejected=tuple(sorted(rejected, key=lambda fault: fault.index or 0)),
    )
