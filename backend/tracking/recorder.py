"""Incident time: cutting readings at whole seconds, and the rows of what was known at each of them."""

import math
from collections.abc import Iterator, Sequence
from operator import attrgetter

import msgspec

from estimator.measurements import AnyReading

LONGEST_PIECE = 256
"""Readings folded in one go: after each piece other incidents may have their turn."""

_epoch = attrgetter("until_t")


class Piece(msgspec.Struct, frozen=True):
    """Readings that are folded in one go.

    Attributes:
        readings: in the order of their epochs.
        row: whole second whose row is the picture before they are folded, Unix seconds; None: no row.
        newest_t: incident time after them, Unix seconds.
    """

    readings: Sequence[AnyReading]
    row: int | None
    newest_t: float


def pieces(
    readings: Sequence[AnyReading], newest_t: float | None, known_t: float = math.inf
) -> Iterator[Piece]:
    """Cut the readings of a batch where incident time passes a whole second.

    Incident time is the running maximum of the epochs up to which readings tell, but never later than they
    came. Row `s` is the picture after everything that was folded before incident time passed `s`; where it
    passes several at once, only the first gets a row: the others would be the same.

    Args:
        readings: of one batch.
        newest_t: incident time before it; None at the beginning.
        known_t: when it came, where the incident goes by the server's clock, Unix seconds.
    """
    piece: list[AnyReading] = []
    row: int | None = None
    for reading in sorted(readings, key=_epoch):
        epoch = min(reading.until_t, known_t)
        passes = newest_t is not None and epoch > math.ceil(newest_t)
        if piece and (passes or len(piece) == LONGEST_PIECE):
            assert newest_t is not None  # noqa: S101 - a piece has readings, and they have epochs
            yield Piece(piece, row, newest_t)
            piece, row = [], None
        if passes:
            row = row_of(newest_t)
        piece.append(reading)
        newest_t = epoch if newest_t is None else max(newest_t, epoch)
    if piece and newest_t is not None:
        yield Piece(piece, row, newest_t)


def row_of(newest_t: float | None) -> int | None:
    """The whole second whose row holds the picture at an incident time: the next one, or that itself."""
    return None if newest_t is None else math.ceil(newest_t)
