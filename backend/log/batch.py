"""A batch of readings on the wire and in the log, and how its readings are decoded again."""

import msgspec

from backend.log.base import LoggedBatch
from backend.log.surrogates import whole_characters
from estimator.measurements import AnyReading
from estimator.measurements.base import EpochSeconds, Identifier


class Batch(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """A batch as gateways post it.

    Attributes:
        gateway: who posts it.
        batch: with `gateway` the idempotency key.
        readings: the readings.
        sent: when the gateway sent it, Unix seconds.
    """

    gateway: Identifier
    batch: Identifier
    readings: list[AnyReading]
    sent: EpochSeconds | None = None


class RawBatch(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A batch whose readings are still bytes, each by itself."""

    gateway: Identifier
    batch: Identifier
    readings: list[msgspec.Raw]
    sent: EpochSeconds | None = None


class SealedBatch(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A batch whose readings are one piece of bytes."""

    gateway: Identifier
    batch: Identifier
    readings: msgspec.Raw
    sent: EpochSeconds | None = None


decode_batch = msgspec.json.Decoder(Batch).decode
decode_raw_batch = msgspec.json.Decoder(RawBatch).decode
decode_sealed_batch = msgspec.json.Decoder(SealedBatch).decode
decode_reading = msgspec.json.Decoder(AnyReading).decode


def take_apart(body: bytes) -> tuple[RawBatch, frozenset[int]]:
    """A batch with its readings each by itself, and the indices of those that hold half a character.

    Raises:
        msgspec.DecodeError: it is no JSON even with whole characters, or no batch.
    """
    try:
        return decode_raw_batch(body), frozenset()
    except msgspec.ValidationError:
        raise
    except msgspec.DecodeError:
        whole = whole_characters(body)
        if whole is None:
            raise
    first, second = (decode_raw_batch(text) for text in whole)
    pairs = zip(first.readings, second.readings, strict=True)
    return first, frozenset(index for index, (one, other) in enumerate(pairs) if bytes(one) != bytes(other))


def accepted_readings(logged: LoggedBatch) -> list[AnyReading]:
    """The readings of a logged batch that go to the estimator, in their order.

    A log outlives the version that wrote it: a reading that was accepted then and is refused now is left out.
    """
    if not logged.rejected:
        try:
            return decode_batch(logged.body).readings
        except msgspec.DecodeError:
            pass
    batch, halved = take_apart(logged.body)
    aside = halved | {fault.index for fault in logged.rejected}
    readings: list[AnyReading] = []
    for index, raw in enumerate(batch.readings):
        if index not in aside:
            try:
                readings.append(decode_reading(raw))
            except msgspec.ValidationError:
                continue
    return readings
