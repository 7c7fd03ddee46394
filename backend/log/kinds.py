"""Which kinds of readings a batch of the log holds, those that were set aside included."""

from collections.abc import Callable
from typing import Any

import msgspec

from backend.log.base import LoggedBatch
from backend.log.batch import decode_sealed_batch
from backend.log.surrogates import decode_sealed, whole_characters

_decode = msgspec.json.Decoder(list[Any]).decode


def holds_one_of(kinds: list[str]) -> Callable[[LoggedBatch], bool]:
    """Tells of batches whether they hold a reading of one of some kinds.

    Args:
        kinds: also such as there are not, which only readings that were set aside can have.
    """
    wanted = frozenset(kinds)
    words = [msgspec.json.encode(kind) for kind in wanted]

    def holds(logged: LoggedBatch) -> bool:
        # Hardly any batch has the words: most need not be taken apart, which takes ten times as long.
        if b"\\" not in logged.body and not any(word in logged.body for word in words):
            return False
        _, readings = decode_sealed(decode_sealed_batch, logged.body)
        return any(_kind_of(reading) in wanted for reading in _taken_apart(readings))

    return holds


def _kind_of(reading: object) -> str | None:
    kind = reading.get("kind") if isinstance(reading, dict) else None
    return kind if isinstance(kind, str) else None


def _taken_apart(readings: bytes) -> list[Any]:
    try:
        return _decode(readings)
    except msgspec.DecodeError:
        whole = whole_characters(readings)
        if whole is None:
            raise
        return _decode(whole[0])
