"""Judging a batch that comes in: which readings go to the estimator, which are set aside, and why."""

import math
import re
from collections.abc import Sequence
from operator import attrgetter

import msgspec

from backend.errors import FieldError, NotUnderstood, TooLarge
from backend.log.batch import Batch, decode_batch, decode_reading, take_apart
from estimator.measurements import Alarm, AnyReading
from estimator.measurements.base import EpochSeconds, SelfReading

FUTURE_TOLERANCE_S = 60.0
"""Gateways' clocks may be this wrong; a reading from later than that would carry incident time away."""

MAX_MESSAGE = 300
"""Characters of a fault's message: it may quote what came, which may be megabytes."""

# What msgspec says, and what it is called on the wire.
_CODES = (
    ("Object missing required field", "missing_field"),
    ("Object contains unknown field", "unknown_field"),
    ("Invalid value", "unknown_kind"),
    ("Invalid enum value", "unknown_value"),
    ("Number out of range", "out_of_bounds"),
    ("Expected `str` matching regex", "not_an_identifier"),
    ("Expected `array` of length", "wrong_length"),
)
_WRONG_TYPE = re.compile(r"Expected `[^`]*`(, got `|$)")
_PLACE = re.compile(r" - at `\$\.?([^`]*)`\Z")
_NAMED_FIELD = re.compile(r"field `([^`]{1,100})`")
_epoch = attrgetter("until_t")


class Judged(msgspec.Struct, frozen=True, kw_only=True):
    """A batch after judgement.

    Attributes:
        gateway: who posts it.
        batch: its name.
        sent: when it was sent, Unix seconds.
        accepted: the readings that go to the estimator.
        rejected: why the others do not, by index.
    """

    gateway: str
    batch: str
    sent: EpochSeconds | None
    accepted: Sequence[AnyReading]
    rejected: tuple[FieldError, ...]


def judge(body: bytes, max_readings: int, now: float | None) -> Judged:
    """Decode a batch and judge each of its readings by itself.

    A batch without readings is one: a gateway may say that it is alive. Where a JSON object names a field
    twice, the last one counts, here and wherever the log is read.

    Args:
        body: the JSON body.
        max_readings: how many it may have.
        now: the server's clock, Unix seconds, for incidents whose clock is live; None for recorded ones.

    Raises:
        NotUnderstood: the body is no JSON in UTF-8, or no batch.
        TooLarge: it has too many readings.
    """
    try:
        batch = decode_batch(body)
    except (msgspec.DecodeError, UnicodeDecodeError):  # the latter tells a place within some text
        return _judge_each(body, max_readings, now)
    except RecursionError as error:
        raise _no_json(error) from error
    _check_count(len(batch.readings), max_readings)
    late_limit = _horizon(batch.sent, now)
    if batch.readings and max(map(_epoch, batch.readings)) > late_limit:
        return _judge_each(body, max_readings, now)
    return _judged(batch)


def _judged(batch: Batch) -> Judged:
    return Judged(
        gateway=batch.gateway, batch=batch.batch, sent=batch.sent, accepted=batch.readings, rejected=()
    )


def _judge_each(body: bytes, max_readings: int, now: float | None) -> Judged:
    """The slow way, taken where at least one reading is to be set aside, or the batch itself is none."""
    try:
        body.decode()  # readings are cut out unread, so that bytes which are no text would pass
        batch, halved = take_apart(body)
    except msgspec.ValidationError as error:
        fault = explain(error)
        raise NotUnderstood(f"The body is no batch of readings: {fault.message}", [fault]) from error
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise _no_json(error) from error
    _check_count(len(batch.readings), max_readings)
    horizon = _horizon(batch.sent, now)
    accepted: list[AnyReading] = []
    rejected: list[FieldError] = []
    for index, raw in enumerate(batch.readings):
        if index in halved:
            rejected.append(_half_a_character(index))
            continue
        try:
            reading = decode_reading(raw)
        except msgspec.ValidationError as error:
            rejected.append(explain(error, index))
        except (msgspec.DecodeError, RecursionError) as error:
            raise _no_json(error) from error
        else:
            # A call for help is not lost because a clock is wrong: it is of when it came.
            if reading.until_t > horizon and not isinstance(reading, Alarm):
                rejected.append(_in_future(reading, horizon, index))
            else:
                accepted.append(reading)
    return Judged(
        gateway=batch.gateway,
        batch=batch.batch,
        sent=batch.sent,
        accepted=accepted,
        rejected=tuple(rejected),
    )


def explain(error: msgspec.ValidationError, index: int | None = None) -> FieldError:
    """What a ValidationError says, as a fault with code and field."""
    text = str(error)
    place = _PLACE.search(text)
    field = place.group(1) if place else ""
    message = text[: place.start()] if place else text
    cause = error.__cause__
    if isinstance(cause, SelfReading):
        code = "self_reading"
    elif isinstance(cause, ValueError):
        code = "contradiction"
    else:
        code = next((code for start, code in _CODES if message.startswith(start)), "")
        code = code or ("wrong_type" if _WRONG_TYPE.match(message) else "out_of_bounds")
    if code in {"missing_field", "unknown_field"} and (named := _NAMED_FIELD.search(message)):
        field = f"{field}.{named.group(1)}" if field else named.group(1)
    elif code == "not_an_identifier":
        message = "Expected an identifier: 1 to 64 of `A-Za-z0-9_.:-`"
    if field:
        message = f"`{field}`: {message}"
    if len(message) > MAX_MESSAGE:
        message = message[: MAX_MESSAGE - 1] + "…"
    return FieldError(code=code, message=message, index=index, field=field[:100] or None)


def _half_a_character(index: int) -> FieldError:
    return FieldError(
        code="half_a_character",
        message="an escape such as `\\ud83d` stands without its other half: cut texts between characters",
        index=index,
    )


def _no_json(error: Exception) -> NotUnderstood:
    if isinstance(error, UnicodeDecodeError):
        return NotUnderstood(f"The body is not UTF-8: {error.reason} at byte {error.start}.")
    if isinstance(error, RecursionError):
        return NotUnderstood("The body is nested too deeply for a batch of readings.")
    return NotUnderstood(f"The body is no JSON in UTF-8: {error}. NaN and infinities are no JSON either.")


def _check_count(count: int, max_readings: int) -> None:
    if count > max_readings:
        raise TooLarge(f"The batch has {count} readings; {max_readings} are taken at most. Send it in parts.")


def _horizon(sent: float | None, now: float | None) -> float:
    """The newest epoch that a reading may have, Unix seconds."""
    known = [clock for clock in (sent, now) if clock is not None]
    return min(known) + FUTURE_TOLERANCE_S if known else math.inf


def _in_future(reading: AnyReading, horizon: float, index: int) -> FieldError:
    ahead_s = reading.until_t - horizon + FUTURE_TOLERANCE_S
    what = "`t`" if reading.until_t == reading.t else "the last sample after `t`"
    return FieldError(
        code="time_in_future",
        message=f"{what} is {ahead_s:.0f} s ahead of the time of sending: check clocks of unit and gateway",
        index=index,
        field="t",
    )
