r"""Lone surrogates: escapes such as `\ud83d` that are half a character, as where a text was cut in an emoji.

JavaScript writes them, RFC 8259 lets a parser take them or not, and msgspec does not. So that one text does
not cost a whole batch, another character stands in for each of them while the batch is taken apart.
"""

import re
from collections.abc import Callable
from typing import Protocol, TypeVar

import msgspec

STAND_INS = (b"fffd", b"fffe")
"""Two, since what reads otherwise with the second than with the first is what was cut."""

MOST = 10_000
"""As many as a batch may have readings: a body with more was not made by cutting texts."""

# In JSON a backslash begins an escape, or is the second half of one: only reading them in order tells which.
# What is sound is passed over in one go, since bodies may have millions of escapes.
_NEXT_LONE = re.compile(
    rb"(?:[^\\]++|\\[^u]|\\u(?![dD][89a-fA-F])|\\u[dD][89abAB][0-9a-fA-F]{2}\\u[dD][c-fC-F][0-9a-fA-F]{2})*+"
    rb"\\u([dD][89a-fA-F][0-9a-fA-F]{2})"
)


class WithReadings(Protocol):
    """What has readings that are one piece of bytes."""

    @property
    def readings(self) -> msgspec.Raw:
        """The bytes of the array."""


Sealed = TypeVar("Sealed", bound=WithReadings)


def whole_characters(text: bytes) -> tuple[bytes, bytes] | None:
    """A JSON text with each of the `STAND_INS` in the place of its lone surrogates, byte for byte as long.

    Returns:
        None where it has none, or more than `MOST`.
    """
    places: list[int] = []
    end = 0
    while len(places) <= MOST and (found := _NEXT_LONE.match(text, end)):
        places.append(found.start(1))
        end = found.end()
    if not 0 < len(places) <= MOST:
        return None
    first, second = (_with(text, places, letter) for letter in STAND_INS)
    return first, second


def _with(text: bytes, places: list[int], letter: bytes) -> bytes:
    changed = bytearray(text)
    for place in places:
        changed[place : place + len(letter)] = letter
    return bytes(changed)


def decode_sealed(decode: Callable[[bytes], Sealed], text: bytes) -> tuple[Sealed, bytes]:
    """Decode what has readings, with their bytes as they came, lone surrogates or not.

    Args:
        decode: decodes it where it has none.
        text: the JSON text.

    Raises:
        msgspec.DecodeError: it is no JSON even with whole characters, or not what `decode` takes.
    """
    try:
        sealed = decode(text)
        return sealed, bytes(sealed.readings)
    except msgspec.ValidationError:
        raise
    except msgspec.DecodeError:
        whole = whole_characters(text)
        if whole is None:
            raise
    sealed = decode(whole[0])
    readings = bytes(sealed.readings)
    # Of a field named twice the last counts.
    start = whole[0].rfind(readings)
    return sealed, text[start : start + len(readings)]
