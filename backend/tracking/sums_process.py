"""What the process for heavy sums does: reads the log and a stored state, and answers in plain values."""

from collections.abc import Iterator
from contextlib import contextmanager

import msgspec
import sqlalchemy as sa
import structlog

from backend.errors import NotFound
from backend.log.base import LogUnreadable
from backend.log.engine import make_engine
from backend.log.read import SqlLogReader
from backend.tracking.clock_set_back import OneClock, earlier
from backend.tracking.fold import IncidentFold, OtherState
from backend.tracking.heads import Head, running
from backend.tracking.known_logs import AHEAD, KnownLog, KnownLogs, entries
from estimator import trackers
from estimator.estimate import Relative, TrackPoint
from estimator.evidence import Advice, Evidence
from estimator.measurements import AnyReading
from estimator.measurements.imu import Imu, told_until
from estimator.trackers.base import Told

Smoothed = dict[str, list[TrackPoint]]

_decode = msgspec.msgpack.Decoder(Smoothed).decode
_known = KnownLogs()
"""Of this process, which does one sum at a time."""

log = structlog.get_logger(__name__)


def smooth_log(database_url: str, head: Head) -> bytes:
    """Every node's track from the whole log, as `smoothed_of` takes it.

    Pickled on their way to the web process, 90,000 points would take half a second, and half of that nothing
    else could be answered.

    Args:
        database_url: SQLAlchemy URL of the log.
        head: the incident; entries after its `last_seq` are left out.

    Raises:
        LogUnreadable: the database failed.
    """
    known = _known_log(database_url, head)
    smoothed = trackers.smoother(head.tracker, head.settings).smooth(known.heard)
    if ahead_s := known.ahead_s:
        smoothed = {node: [earlier(point, ahead_s) for point in track] for node, track in smoothed.items()}
    return msgspec.msgpack.encode(smoothed)


def smoothed_of(encoded: bytes) -> Smoothed:
    """The tracks that `smooth_log` gives, to the last bit."""
    return _decode(encoded)


def evidence_of_log(database_url: str, head: Head, node: str, t: float | None) -> Evidence | None:
    """What holds a node's fix at a moment, with everything that the whole log says of epochs up to it.

    An entry that came later than `t` but tells of epochs before it counts; readings of later epochs do not.

    Args:
        database_url: SQLAlchemy URL of the log.
        head: the incident; entries after its `last_seq` are left out.
        node: the node.
        t: the moment, Unix seconds; None: the newest epoch.

    Returns:
        The evidence; None where the node's position is not decided at that time.

    Raises:
        NotFound: no reading up to that moment names the node.
        LogUnreadable: the database failed.
    """
    told: Told
    if t is None:
        known = _known_log(database_url, head)
        told, ahead_s = known.heard, known.ahead_s
    else:
        told, ahead_s = _known_by(database_url, head, t)
    try:
        evidence = trackers.smoother(head.tracker, head.settings).evidence(told, node)
    except KeyError as error:
        raise _not_named(node, t) from error
    return evidence if evidence is None or not ahead_s else _told_earlier(evidence, ahead_s)


def advice_of_log(database_url: str, head: Head, node: str) -> Advice | None:
    """What would make a node's newest position surer, from the whole log.

    Args:
        database_url: SQLAlchemy URL of the log.
        head: the incident; entries after its `last_seq` are left out.
        node: the node.

    Returns:
        The advice; None where the node's position is not decided.

    Raises:
        NotFound: no reading names the node.
        LogUnreadable: the database failed.
    """
    known = _known_log(database_url, head)
    try:
        return trackers.smoother(head.tracker, head.settings).advice(known.heard, node)
    except KeyError as error:
        raise _not_named(node, None) from error


def read_ahead(database_url: str) -> bool:
    """Read on in the logs of incidents that run, a few entries of each: somebody may ask about one.

    Args:
        database_url: SQLAlchemy URL of the log.

    Returns:
        Whether there may be more entries.

    Raises:
        LogUnreadable: the database failed.
    """
    more = False
    with _engine(database_url) as engine:
        for head in running(engine)[-AHEAD:]:
            try:
                more |= _known.read_ahead(SqlLogReader(engine), head, database_url)
            except LogUnreadable:
                raise
            except Exception:
                # Whoever asks about it is told; the others are not to wait for it.
                log.exception("an incident cannot be folded ahead", incident=head.incident)
                _known.give_up(head, database_url)
    return more


def _known_log(database_url: str, head: Head) -> KnownLog:
    with _engine(database_url) as engine:
        return _known.up_to(SqlLogReader(engine), head, database_url)


def _known_by(database_url: str, head: Head, t: float) -> tuple[list[AnyReading], int]:
    """What the whole log tells of epochs up to `t` (Unix seconds), and by how much its clock is ahead (s).

    Of raw samples the first part, of other readings all or nothing.
    """
    clock, readings = OneClock(head.live), list[AnyReading]()
    with _engine(database_url) as engine:
        for entry in entries(SqlLogReader(engine), head):
            readings += clock.take(*entry)
    until_t = t + clock.ahead_s
    parts = (told_until(r, until_t) if isinstance(r, Imu) else r for r in readings if r.t <= until_t)
    return [part for part in parts if part is not None], clock.ahead_s


def _not_named(node: str, t: float | None) -> NotFound:
    when = "yet" if t is None else f"up to t = {t:.3f}"
    return NotFound(f"No reading of this incident has named {node!r} {when}.")


def _told_earlier(evidence: Evidence, by_s: float) -> Evidence:
    return earlier(
        msgspec.structs.replace(
            evidence,
            held=[earlier(one, by_s) for one in evidence.held],
            rejected=[earlier(one, by_s) for one in evidence.rejected],
        ),
        by_s,
    )


def relative_from_state(database_url: str, head: Head, a: str, b: str) -> Relative | None:
    """Where `b` is relative to `a` after the newest stored state; None where either is undecided.

    Raises:
        NotFound: a node is not known.
        OtherState: there is no state yet, or none that can be used: `relative_of_log` tells.
        LogUnreadable: the database failed.
    """
    with _engine(database_url) as engine:
        snapshot = SqlLogReader(engine).snapshot(head.incident)
    if snapshot is None:
        raise OtherState("no state is stored yet")
    return _relative(IncidentFold.restore(snapshot.state, head.tracker, head.settings, head.live), a, b)


def relative_of_log(database_url: str, head: Head, a: str, b: str) -> Relative | None:
    """Where `b` is relative to `a`, with the log folded from its start; None where either is undecided.

    Args:
        database_url: SQLAlchemy URL of the log.
        head: the incident; entries after its `last_seq` are left out.
        a: the one node.
        b: the other node.

    Raises:
        NotFound: a node is not known.
        LogUnreadable: the database failed.
    """
    fold = IncidentFold(head.tracker, head.settings, head.live)
    with _engine(database_url) as engine:
        for batch, readings in entries(SqlLogReader(engine), head):
            for _ in fold.fold(batch, readings):
                pass
    return _relative(fold, a, b)


def _relative(fold: IncidentFold, a: str, b: str) -> Relative | None:
    try:
        return fold.relative(a, b)
    except KeyError as error:
        raise NotFound(f"There is no node {error.args[0]!r} in this incident.") from error


@contextmanager
def _engine(database_url: str) -> Iterator[sa.Engine]:
    engine = make_engine(database_url)
    try:
        yield engine
    finally:
        engine.dispose()
