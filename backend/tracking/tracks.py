"""Tracks as they were shown: the recorded rows, presented at their whole second."""

from collections.abc import Container, Iterator

import numpy as np

from backend.errors import Invalid
from backend.live.frame import Track, Tracks
from backend.live.presentation import covariance_at
from backend.live.record import PictureRecord, decode
from backend.log.base import LogReader

MAX_POINTS = 1_000_000
"""Points of one answer: some 150 MB of JSON."""

FILL_S = 300
"""A row stands until the next one; after so long without news a track has a gap."""

Standing = tuple[int, PictureRecord]
"""A second, and the record that stands from it on."""

Stored = tuple[int, PictureRecord | bytes]
"""The same, where the record may be encoded still: what falls between two points is never decoded."""

Point = tuple[float, float, float, float, float, float, float, float, float, float]


def live_tracks(
    reader: LogReader,
    incident: str,
    wanted: Container[str] | None,
    start: float | None,
    end: float | None,
    step_s: int,
    newest: Standing | None = None,
) -> Tracks:
    """The estimate as it stood at each whole second of incident time.

    Args:
        reader: of the recorded rows.
        incident: whose.
        wanted: only these nodes; None: all.
        start: first second, Unix seconds; None: the first recorded one.
        end: last second, Unix seconds; None: the last recorded one.
        step_s: seconds from point to point; points fall on its multiples.
        newest: a whole second that is now, and what is known: its row is not final yet.

    Raises:
        Invalid: it would be too many points.
        LogUnreadable: the database failed.
    """
    tracks: dict[str, list[Point]] = {}
    points = 0
    for second, record in _seconds(reader, incident, start, end, step_s, newest):
        for known in record.nodes:
            if wanted is not None and known.node not in wanted:
                continue
            covariance = covariance_at(known, second)
            if known.position_m is None or covariance is None or known.retired:
                continue
            tracks.setdefault(known.node, []).append((float(second), *known.position_m, *covariance))
            points += 1
        if points > MAX_POINTS:
            raise Invalid(
                f"The answer would have more than {MAX_POINTS} points: "
                "ask for one `node`, a shorter time or a larger `step`."
            )
    return Tracks(tracks=[Track(node=name, points=track) for name, track in tracks.items()])


def rounded(tracks: Tracks, decimals: int) -> Tracks:
    """Tracks with so many decimals of their m and m²: less than half of the bytes, for who draws them."""
    return Tracks(
        tracks=[Track(node=one.node, points=_rounded(one.points, decimals)) for one in tracks.tracks]
    )


def _rounded(points: list[Point], decimals: int) -> list[Point]:
    if not points:
        return points
    numbers = np.array(points)
    numbers[:, 1:] = np.round(numbers[:, 1:], decimals) + 0.0  # no "-0.0"
    return list(map(tuple, numbers.tolist()))


def _seconds(
    reader: LogReader,
    incident: str,
    start: float | None,
    end: float | None,
    step_s: int,
    newest: Standing | None,
) -> Iterator[Standing]:
    """Each multiple of the step with the record that stood then."""
    before: Stored | None = None
    if start is not None:
        row = reader.frame_at(incident, start)
        if row is not None and row.second < start:
            before = row.second, row.record
    for (since, record), until in _periods(_standing(reader, incident, start, newest), before):
        if end is not None and since > end:
            return
        for second in range(since + -since % step_s, min(until, since + 1 + FILL_S), step_s):
            if end is not None and second > end:
                return
            if start is None or second >= start:
                if isinstance(record, bytes):
                    record = decode(record)  # noqa: PLW2901 - the same record
                yield second, record


def _standing(
    reader: LogReader, incident: str, start: float | None, newest: Standing | None
) -> Iterator[Stored]:
    """Records and the seconds from which they stand."""
    last: int | None = None
    for row in reader.frames(incident, start):
        last = row.second
        yield row.second, row.record
    if newest is not None and (last is None or newest[0] > last):
        yield newest


def _periods(records: Iterator[Stored], before: Stored | None) -> Iterator[tuple[Stored, int]]:
    """Each record with the second from which another stands."""
    for record in records:
        if before is not None:
            yield before, record[0]
        before = record
    if before is not None:
        yield before, before[0] + 1
