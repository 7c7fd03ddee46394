"""What was known and shown at a moment of the past."""

from backend.live.frame import Frame
from backend.live.presentation import present
from backend.live.record import EMPTY, PictureRecord, decode
from backend.log.base import LogReader, RecordedFrame
from backend.log.incident import Incident

SHOWN_WITHIN_S = 1.0
"""A row of a second whose readings came later than this after it was not on any screen at that moment."""


def row_at(reader: LogReader, incident: Incident, t: float) -> RecordedFrame | None:
    """The newest row that could be seen at a moment; None before the first.

    Args:
        reader: of the recorded rows.
        incident: in one with a `live` clock a row counts only if its readings had come by then.
        t: the moment, Unix seconds.

    Raises:
        LogUnreadable: the database failed.
    """
    received_by = t + SHOWN_WITHIN_S if incident.clock == "live" else None
    return reader.frame_at(incident.id, t, received_by)


def record_of(row: RecordedFrame | None) -> PictureRecord:
    """What a row says; nothing, where there is none.

    Raises:
        UnknownRecord: another version wrote the row.
    """
    return EMPTY if row is None else decode(row.record)


def told_at(incident: Incident, t: float, row: RecordedFrame | None = None) -> Incident:
    """An incident as it was set at a moment: its origin, levels and settings of then.

    Args:
        incident: as it is known now.
        t: the moment, Unix seconds; it tells in one with a `live` clock.
        row: the newest that could be seen then; it tells where the readings are the clock.
    """
    told = incident.stretches[0]
    for stretch in incident.stretches[1:]:
        if incident.clock == "live":
            begun = stretch.since <= t
        else:
            begun = row is not None and (stretch.after_seq, stretch.since) <= (row.seq, row.received)
        if not begun:
            break
        told = stretch
    return incident.set_to(told)


def frame_of(row: RecordedFrame | None, incident: Incident, t: float) -> Frame:
    """The frame that a row is at a moment.

    Raises:
        UnknownRecord: another version wrote the row.
    """
    return present(record_of(row), 0 if row is None else row.seq, t, told_at(incident, t, row))
