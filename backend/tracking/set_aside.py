"""Who sends readings of which none can be used: as whom it speaks, and what is wrong with them."""

from collections.abc import Collection, Mapping
from typing import Any

import msgspec

from backend.errors import FieldError
from backend.live.record import RecordAside
from backend.log.base import LoggedBatch
from backend.log.batch import take_apart

KEPT = 64
"""A gateway that makes up names fills no more than this."""

LONGEST_NAME = 64
LONGEST_REASON = 120


class _Said(msgspec.Struct):
    """What a reading that was set aside may say of whom it is; nothing of it is to be relied on."""

    t: Any = None
    node: Any = None
    a: Any = None
    callsign: Any = None
    crew: Any = None


_decode = msgspec.json.Decoder(_Said).decode


def after_batch(
    before: Mapping[str, RecordAside], batch: LoggedBatch, came_t: float, usable: Collection[str]
) -> dict[str, RecordAside]:
    """Whose readings were set aside, after a batch in which some were.

    Args:
        before: the same before it, by name.
        batch: what came.
        came_t: when, by the incident's clock, Unix seconds.
        usable: the nodes of which the same batch holds a reading that can be used.
    """
    after = dict(before)
    try:
        raws = take_apart(batch.body)[0].readings
    except msgspec.DecodeError:
        return after  # the row is damaged: it was understood when it came in
    for fault in batch.rejected:
        if fault.index is None or fault.index >= len(raws):
            continue
        said = _said(raws[fault.index])
        name = _text(said.node) or _text(said.a) or ""
        if name in usable:
            continue
        known = after.pop(name, None)
        after[name] = RecordAside(
            name=name,
            gateway=batch.gateway,
            since_t=came_t if known is None else known.since_t,
            t=came_t,
            code=fault.code,
            text=_reason(fault, said, batch),
            callsign=_text(said.callsign) or (None if known is None else known.callsign),
            crew=_text(said.crew) or (None if known is None else known.crew),
        )
    for name in list(after)[:-KEPT]:
        del after[name]
    return after


def _said(raw: msgspec.Raw) -> _Said:
    try:
        return _decode(raw)
    except (msgspec.DecodeError, UnicodeDecodeError):
        return _Said()


def _text(said: object) -> str | None:
    """What can be shown of a name; None where there is none."""
    if not isinstance(said, str):
        return None
    return "".join(letter for letter in said if letter.isprintable()).strip()[:LONGEST_NAME] or None


def _reason(fault: FieldError, said: _Said, batch: LoggedBatch) -> str:
    """What is wrong, in the words of whom it is to be told."""
    if fault.code == "time_in_future" and isinstance(said.t, (int, float)):
        sent_t = batch.received if batch.sent is None else min(batch.sent, batch.received)
        return f"clock {_span(said.t - sent_t)} ahead: set it"
    message = fault.message if len(fault.message) <= LONGEST_REASON else fault.message[:LONGEST_REASON] + "…"
    return f"readings not understood: {message}"


def _span(seconds: float) -> str:
    """A time as it is said: so coarse that it stays the same from batch to batch."""
    for unit, length_s in (("days", 86_400.0), ("h", 3_600.0), ("min", 60.0)):
        count = round(seconds / length_s)
        if count >= 2:
            return f"{count} {unit}"
    return f"{round(seconds)} s"
