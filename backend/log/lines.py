"""A batch as a line of NDJSON: what `GET …/log` sends, `firethread export` writes and `import` reads."""

from typing import Annotated, Any

import msgspec
from msgspec import Meta

from backend.errors import FieldError, NotUnderstood
from backend.log.base import LoggedBatch
from backend.log.batch import decode_sealed_batch
from backend.log.surrogates import decode_sealed
from estimator.measurements.base import EpochSeconds, Identifier


class Line(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A line of a recorded log; unknown fields are passed over, so that newer logs stay readable.

    Attributes:
        incident: what it is a log of, in the first line of a file; see `recordings/about.py`.
        seq: its place in the log that it comes from.
        received: when it came there, Unix seconds.
        gateway: who posted it.
        batch: its name.
        sent: when the gateway sent it, Unix seconds.
        rejected: the readings that were set aside there, by index.
        readings: the bytes of the array of readings, as they came.
    """

    incident: dict[str, Any] | None = None
    seq: Annotated[int, Meta(ge=0)] | None = None
    received: EpochSeconds | None = None
    gateway: Identifier
    batch: Identifier
    sent: EpochSeconds | None = None
    rejected: tuple[FieldError, ...] = ()
    readings: msgspec.Raw

    def body(self) -> bytes:
        """The body of the telemetry request that posts this batch (again)."""
        head: dict[str, object] = {"gateway": self.gateway, "batch": self.batch}
        if self.sent is not None:
            head["sent"] = self.sent
        return msgspec.json.encode(head | {"readings": self.readings})


_decode = msgspec.json.Decoder(Line).decode


def log_line(logged: LoggedBatch, incident: dict[str, Any] | None = None) -> bytes:
    """The line of a batch, newline included; `readings` are the bytes that came.

    Line breaks between tokens become spaces, so that a line stays a line (inside strings JSON has none).

    Args:
        logged: the batch.
        incident: what its log is of, where that is to be said.
    """
    _, readings = decode_sealed(decode_sealed_batch, logged.body)
    return (
        msgspec.json.encode(
            Line(
                incident=incident,
                seq=logged.seq,
                received=logged.received,
                gateway=logged.gateway,
                batch=logged.batch,
                sent=logged.sent,
                rejected=logged.rejected,
                readings=msgspec.Raw(readings.translate(_BREAKS_TO_SPACES)),
            )
        )
        + b"\n"
    )


_BREAKS_TO_SPACES = bytes.maketrans(b"\r\n", b"  ")


def parse_line(line: bytes) -> Line:
    """The inverse of `log_line`; all but `gateway`, `batch` and `readings` may be missing.

    Raises:
        NotUnderstood: the line is no JSON, or no batch.
    """
    try:
        parsed, readings = decode_sealed(_decode, line)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise NotUnderstood(f"The line is no batch of a recorded log: {error}") from error
    return msgspec.structs.replace(parsed, readings=msgspec.Raw(readings))
