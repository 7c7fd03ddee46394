"""What the web process and the log's writer process say to each other, over a pair of sockets.

To the writer: the database's URL, then batches, each a head in MessagePack and the body as it came. Back: for
each group written, what became of its batches, in their order; first a group of nothing, when it is there.
"""

import struct
from collections.abc import Iterator
from typing import Literal

import msgspec

from backend.errors import Conflict, FieldError, NotFound, Problem
from backend.log.base import Appended, LogUnwritable, NewBatch

LENGTHS = struct.Struct("<II")
"""Bytes of the head and of the body that follow."""

Kind = Literal["not_found", "conflict", "unwritable", "defect"]
_KINDS: dict[type[Problem], Kind] = {NotFound: "not_found", Conflict: "conflict", LogUnwritable: "unwritable"}
_PROBLEMS: dict[Kind, type[Problem]] = {kind: problem for problem, kind in _KINDS.items()}


class Head(msgspec.Struct, frozen=True, array_like=True):
    """A batch without its body; the fields of `NewBatch`."""

    incident: str
    gateway: str
    batch: str
    received: float
    sent: float | None
    accepted: int
    rejected: tuple[FieldError, ...]


class Refused(msgspec.Struct, frozen=True, array_like=True):
    """A problem on its way back."""

    kind: Kind
    detail: str
    retry_after_s: int | None


class Written(msgspec.Struct, frozen=True, array_like=True):
    """What became of a group.

    Attributes:
        seconds: how long it took.
        outcomes: for each batch the one or the other.
    """

    seconds: float
    outcomes: list[tuple[Appended | None, Refused | None]]


_encode = msgspec.msgpack.Encoder().encode
_decode_head = msgspec.msgpack.Decoder(Head).decode
_decode_written = msgspec.msgpack.Decoder(Written).decode


def batch_frame(batch: NewBatch) -> tuple[bytes, bytes]:
    """A batch as two pieces: lengths and head, and the body, which is not copied."""
    head = _encode(
        Head(
            batch.incident,
            batch.gateway,
            batch.batch,
            batch.received,
            batch.sent,
            batch.accepted,
            batch.rejected,
        )
    )
    return LENGTHS.pack(len(head), len(batch.body)) + head, batch.body


def parse_batch(head: bytes, body: bytes) -> NewBatch:
    """The inverse of `batch_frame`."""
    of = _decode_head(head)
    return NewBatch(
        incident=of.incident,
        gateway=of.gateway,
        batch=of.batch,
        received=of.received,
        sent=of.sent,
        body=body,
        accepted=of.accepted,
        rejected=of.rejected,
    )


def written_frame(seconds: float, outcomes: list[Appended | Problem]) -> bytes:
    """What became of a group, as one piece."""
    payload = _encode(
        Written(
            seconds,
            [
                (None, _refused(outcome)) if isinstance(outcome, Problem) else (outcome, None)
                for outcome in outcomes
            ],
        )
    )
    return LENGTHS.pack(len(payload), 0) + payload


def parse_written(payload: bytes) -> Written:
    """The inverse of `written_frame`, lengths taken off."""
    return _decode_written(payload)


def problem_of(refused: Refused) -> Problem:
    """The problem that was refused with, as an exception of its own."""
    return _PROBLEMS.get(refused.kind, Problem)(refused.detail, retry_after_s=refused.retry_after_s)


class Frames:
    """Cuts a stream of bytes into frames."""

    def __init__(self) -> None:
        self._buffer = bytearray()

    def feed(self, data: bytes) -> Iterator[tuple[bytes, bytes]]:
        """Head and body of every frame that is whole now."""
        buffer = self._buffer
        buffer += data
        start = 0
        while len(buffer) - start >= LENGTHS.size:
            head, body = LENGTHS.unpack_from(buffer, start)
            middle = start + LENGTHS.size + head
            if len(buffer) < middle + body:
                break
            yield bytes(buffer[start + LENGTHS.size : middle]), bytes(buffer[middle : middle + body])
            start = middle + body
        del buffer[:start]


def _refused(problem: Problem) -> Refused:
    return Refused(_KINDS.get(type(problem), "defect"), problem.detail, problem.retry_after_s)
