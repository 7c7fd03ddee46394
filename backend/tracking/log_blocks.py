"""Reading the log ahead of the fold."""

import msgspec
import structlog

from backend.log.base import LoggedBatch, LogReader
from backend.log.batch import accepted_readings
from estimator.measurements import AnyReading

READ_BATCHES = 64
READ_BYTES = 1024 * 1024
"""Decoded readings take some ten times the bytes of their JSON."""

Decoded = tuple[LoggedBatch, list[AnyReading]]

log = structlog.get_logger(__name__)


def read_block(reader: LogReader, incident: str, after: int) -> list[Decoded]:
    """The next entries of a log with those of their readings that go to the estimator.

    Args:
        reader: of the log.
        incident: whose log.
        after: entries with a larger `seq` are read.

    Raises:
        LogUnreadable: the database failed.
    """
    block: list[Decoded] = []
    size = 0
    for batch in reader.batches(incident, after=after, limit=READ_BATCHES):
        block.append((batch, _readings(incident, batch)))
        size += len(batch.body)
        if size >= READ_BYTES:
            break
    return block


def _readings(incident: str, batch: LoggedBatch) -> list[AnyReading]:
    try:
        return accepted_readings(batch)
    except msgspec.DecodeError as error:
        # It was understood when it came in: the row is damaged, and the picture goes on without it.
        log.error("a log entry cannot be decoded", incident=incident, seq=batch.seq, error=str(error))
        return []
