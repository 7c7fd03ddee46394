"""What the process for heavy sums does: reads the log and a stored state, and answers in plain values."""

import math
from collections.abc import Iterable, Iterator

import msgspec

from backend.errors import NotFound
from backend.log.engine import make_engine
from backend.log.read import SqlLogReader
from backend.tracking.clock_set_back import earlier, on_one_clock
from backend.tracking.fold import IncidentFold, OtherState
from backend.tracking.heads import Head
from backend.tracking.log_blocks import Decoded, read_block
from estimator import trackers
from estimator.estimate import Relative, TrackPoint
from estimator.evidence import Advice, Evidence
from estimator.measurements import AnyReading
from estimator.measurements.imu import Imu, told_until

Smoothed = dict[str, list[TrackPoint]]

_decode = msgspec.msgpack.Decoder(Smoothed).decode


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
    readings, ahead_s = _whole_log(database_url, head)
    smoothed = trackers.smoother(head.tracker, head.settings).smooth(readings)
    if ahead_s:
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
    readings, ahead_s = _whole_log(database_url, head)
    known = _known_by(readings, math.inf if t is None else t + ahead_s)
    try:
        evidence = trackers.evidence(head.tracker, head.settings, known, node)
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
    readings, _ = _whole_log(database_url, head)
    try:
        return trackers.advice(head.tracker, head.settings, readings, node)
    except KeyError as error:
        raise _not_named(node, None) from error


def _known_by(readings: Iterable[AnyReading], t: float) -> list[AnyReading]:
    """What readings tell of epochs up to `t` (s): of raw samples the first part, of others all or nothing."""
    parts = (told_until(r, t) if isinstance(r, Imu) else r for r in readings if r.t <= t)
    return [part for part in parts if part is not None]


def _not_named(node: str, t: float | None) -> NotFound:
    when = "yet" if t is None else f"up to t = {t:.3f}"
    return NotFound(f"No reading of this incident has named {node!r} {when}.")


def _whole_log(database_url: str, head: Head) -> tuple[list[AnyReading], int]:
    """All readings on one clock, and by how much it is ahead of the server's in the end (s)."""
    engine = make_engine(database_url)
    try:
        return on_one_clock(_entries(SqlLogReader(engine), head), head.live)
    finally:
        engine.dispose()


def _told_earlier(evidence: Evidence, by_s: float) -> Evidence:
    return earlier(
        msgspec.structs.replace(
            evidence,
            held=[earlier(one, by_s) for one in evidence.held],
            rejected=[earlier(one, by_s) for one in evidence.rejected],
        ),
        by_s,
    )


def _entries(reader: SqlLogReader, head: Head) -> Iterator[Decoded]:
    seq = 0
    while seq < head.last_seq and (block := read_block(reader, head.incident, seq)):
        for batch, readings in block:
            if batch.seq <= head.last_seq:
                yield batch, readings
        seq = block[-1][0].seq


def relative_from_state(database_url: str, head: Head, a: str, b: str) -> Relative | None:
    """Where `b` is relative to `a` after the newest stored state; None where either is undecided.

    Raises:
        NotFound: a node is not known.
        OtherState: there is no state yet, or none that can be used: `relative_of_log` tells.
        LogUnreadable: the database failed.
    """
    engine = make_engine(database_url)
    try:
        snapshot = SqlLogReader(engine).snapshot(head.incident)
    finally:
        engine.dispose()
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
    engine = make_engine(database_url)
    try:
        for batch, readings in _entries(SqlLogReader(engine), head):
            for _ in fold.fold(batch, readings):
                pass
    finally:
        engine.dispose()
    return _relative(fold, a, b)


def _relative(fold: IncidentFold, a: str, b: str) -> Relative | None:
    try:
        return fold.relative(a, b)
    except KeyError as error:
        raise NotFound(f"There is no node {error.args[0]!r} in this incident.") from error
