"""Recorded logs as NDJSON files: the lines that `GET …/log` gives go in, and come out again byte for byte.

The first line of an export says of which incident it is, where that is not what the lines alone become.
"""

import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import NamedTemporaryFile

import msgspec
import sqlalchemy as sa

from backend.errors import NotFound, NotUnderstood, Problem, in_reach
from backend.log.append import append_group
from backend.log.base import NewBatch
from backend.log.engine import make_engine
from backend.log.incident import Clock, Incident, Level, Origin, Stretch
from backend.log.incidents import IncidentStore
from backend.log.lines import log_line
from backend.log.migrate import prepare
from backend.log.read import SqlLogReader
from backend.recordings.about import about
from backend.recordings.exported import Numbered, about_in, batches_in

STANDARD_INPUT = Path("-")

GROUP_BATCHES = 256
GROUP_BYTES = 8 * 1024 * 1024

NOT_FINISHED = " (import not finished)"
"""After the name of an incident until its last line is stored: what was broken off is no whole record."""

NAME_LETTERS = 200 - len(NOT_FINISHED)
"""So many of its name fit before that."""

Progress = Callable[[int, int], None]
"""Called with the lines written so far and all lines of the file."""


class Imported(msgspec.Struct, frozen=True, kw_only=True):
    """What became of a file.

    Attributes:
        incident: the id of the new incident.
        batches: how many entries its log has.
        duplicates: lines whose gateway and batch had come before in the file.
        accepted: readings that go to the estimator.
        rejected: readings that were set aside.
    """

    incident: str = ""
    batches: int = 0
    duplicates: int = 0
    accepted: int = 0
    rejected: int = 0

    def plus(self, more: "Imported") -> "Imported":
        """The sums of both, for the incident of this one."""
        return Imported(
            incident=self.incident,
            batches=self.batches + more.batches,
            duplicates=self.duplicates + more.duplicates,
            accepted=self.accepted + more.accepted,
            rejected=self.rejected + more.rejected,
        )


def import_log(
    url: str,
    name: str | None,
    path: Path,
    clock: Clock | None = None,
    levels: list[Level] | None = None,
    origin: Origin | None = None,
    settings: dict[str, object] | None = None,
    progress: Progress | None = None,
) -> Imported:
    """Write a recorded log into a new incident, past the server: each import makes an incident of its own.

    The whole file is read and understood before anything is stored. A line without `received` is taken to
    have come when it was sent, or at its newest reading; `seq` counts the lines anew. Readings are judged as
    ingest judges them; those that the line itself lists as rejected stay so. The incident gets its name with
    the last line: until then, and for ever where the import is broken off, `NOT_FINISHED` stands after it.

    What is given here goes before what the file says of its incident, at all times; what neither says has its
    default. What was set under way is set after the same line.

    Args:
        url: SQLAlchemy URL of the log's database; it is created or migrated where needed.
        name: of the incident.
        path: of the file; `-` is standard input.
        clock: of the incident.
        levels: its storeys.
        origin: of its local coordinates.
        settings: those that are not as in the file, by name.
        progress: told after each transaction.

    Raises:
        NotUnderstood: a line is no batch, and the message names it; or there is none, or no name.
        Invalid: a setting is out of bounds, or they contradict each other.
        TooLarge: a line has more readings than a batch may have.
        SchemaTooNew: a newer version has written the database.
        CommandRefused: the file cannot be read.
        Problem: the log refused a batch, for one because somebody has closed the incident meanwhile.
        LogUnwritable: the database cannot be written.
    """
    with _readable_twice(path) as (file, said):
        known = about_in(file, said)
        given = {"name": name, "clock": clock}
        known = known.model_copy(update={field: value for field, value in given.items() if value is not None})
        known = known.with_options(levels, origin, settings or {})
        if known.name is None:
            raise NotUnderstood(f"{said} does not say the name of its incident: give it one by --incident.")
        total = sum(1 for _ in batches_in(file, "", known.clock, said))
        if total == 0:
            raise NotUnderstood(f"{said} holds no batch: an export of an incident has a line for each.")
        prepare(url)
        engine = make_engine(url)
        try:
            store = IncidentStore(engine)
            unfinished = known.name[:NAME_LETTERS] + NOT_FINISHED
            incident = store.create(
                unfinished, known.clock, known.origin, known.levels, known.settings, known.created
            ).id
            imported, written, coming = Imported(incident=incident), 0, list(known.changes)
            for group in _groups(batches_in(file, incident, known.clock, said), known.changes):
                while coming and coming[0].after_seq < group[0][0]:
                    _set(store, incident, coming.pop(0))
                imported = imported.plus(_append(engine, [batch for _, batch in group]))
                written += len(group)
                if progress is not None:
                    progress(written, total)
            for change in coming:
                _set(store, incident, change)
            closed = {} if known.closed is None else {"state": "closed", "closed": known.closed}
            store.change(incident, {"name": known.name} | closed)
            return imported
        finally:
            engine.dispose()


@contextmanager
def _readable_twice(path: Path) -> Iterator[tuple[Path, str]]:
    """A file to understand first and to store then, and what it is called: of a pipe, a copy on disk."""
    if path != STANDARD_INPUT:
        yield path, str(path)
        return
    with NamedTemporaryFile(prefix="firethread-", suffix=".ndjson") as copy:
        with in_reach("standard input, or its copy on disk,"):
            shutil.copyfileobj(sys.stdin.buffer, copy)
            copy.flush()
        yield Path(copy.name), "standard input"


def export_log(url: str, incident: str) -> Iterator[bytes]:
    """The lines of an incident's log in `seq` order, newline included; the first says what it is, if need be.

    Args:
        url: SQLAlchemy URL of the log's database.
        incident: its id, or its name where no other incident has it.

    Raises:
        NotFound: there is no such incident, or several have that name; the message lists them.
        SchemaTooNew: a newer version has written the database.
        LogUnwritable: the database cannot be reached.
    """
    prepare(url)
    engine = make_engine(url)
    try:
        found = find_incident(IncidentStore(engine), incident)
        said = about(found)
        for logged in SqlLogReader(engine).batches(found.id):
            yield log_line(logged, said)
            said = None
    finally:
        engine.dispose()


def find_incident(store: IncidentStore, name: str) -> Incident:
    """The incident with id or name `name`.

    Raises:
        NotFound: there is none, or several have that name.
    """
    known = store.all()
    found = [one for one in known if one.id == name] or [one for one in known if one.name == name]
    if len(found) == 1:
        return found[0]
    what = f"{len(found)} incidents are called {name!r}" if found else f"There is no incident {name!r}"
    listed = ", ".join(f"{one.id} ({one.name})" for one in (found or known)[-10:]) or "none at all"
    raise NotFound(f"{what}: give one of these ids: {listed}.")


def _set(store: IncidentStore, incident: str, change: Stretch) -> None:
    store.change(incident, change.model_dump(exclude={"after_seq"}))


def _groups(batches: Iterator[Numbered], changes: Sequence[Stretch]) -> Iterator[list[Numbered]]:
    """Batches in groups of a size that one transaction holds well, and between which settings changed."""
    ends = [change.after_seq for change in changes]
    group: list[Numbered] = []
    size = 0
    for seq, batch in batches:
        if group and any(group[-1][0] <= end < seq for end in ends):
            yield group
            group, size = [], 0
        group.append((seq, batch))
        size += len(batch.body)
        if len(group) >= GROUP_BATCHES or size >= GROUP_BYTES:
            yield group
            group, size = [], 0
    if group:
        yield group


def _append(engine: sa.Engine, group: list[NewBatch]) -> Imported:
    """Append a group; what became of it."""
    batches = duplicates = accepted = rejected = 0
    for outcome in append_group(engine, group):
        if isinstance(outcome, Problem):
            raise outcome
        if outcome.duplicate:
            duplicates += 1
        else:
            batches += 1
            accepted += outcome.accepted
            rejected += len(outcome.rejected)
    return Imported(batches=batches, duplicates=duplicates, accepted=accepted, rejected=rejected)
