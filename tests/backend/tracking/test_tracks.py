"""Live tracks, from recorded rows alone."""

import pytest

from backend.live.record import PictureRecord, RecordNode, decode, encode
from backend.log.base import RecordedFrame
from backend.log.derived import SqlDerivedWriter
from backend.log.engine import make_engine
from backend.log.read import SqlLogReader
from backend.log.schema import leases
from backend.tracking import tracks
from backend.tracking.tracks import FILL_S, Point, live_tracks

FIRST = 10_001
SILENT = range(10_400, 10_400 + FILL_S + 100)
LAST = 11_000


def row(second: int) -> RecordedFrame:
    """What was known when somebody who walks east was as many metres from where it began."""
    place = (float(second - FIRST), 0.0, 0.0)
    node = RecordNode(
        node="ff1", role="responder", t=second, position_m=place, covariance_m2=(1, 0, 0, 1, 0, 1)
    )
    record = encode(PictureRecord(t=second, nodes=(node,)))
    return RecordedFrame(second=second, seq=second, received=float(second), record=record)


@pytest.fixture
def reader(sqlite_url: str) -> SqlLogReader:
    """A walk with a time in which nothing was heard: longer than a row stands."""
    engine = make_engine(sqlite_url)
    with engine.execution_options(writes=True).begin() as connection:
        connection.execute(leases.insert().values(incident="i1", holder="north", epoch=1, expires=0.0))
    rows = [row(second) for second in range(FIRST, LAST + 1) if second not in SILENT]
    SqlDerivedWriter(engine).save("i1", 1, rows, None)
    return SqlLogReader(engine)


def points(
    reader: SqlLogReader, step_s: int, start: float | None = None, end: float | None = None
) -> list[Point]:
    """The track of the only one there is."""
    found = live_tracks(reader, "i1", None, start, end, step_s).tracks
    return list(found[0].points) if found else []


@pytest.mark.parametrize("step_s", [2, 7, 60, 3600])
@pytest.mark.parametrize(("start", "end"), [(None, None), (10_390.5, 10_950.0), (10_500.0, 10_999.5)])
def test_a_thinned_track_has_the_points_of_the_whole_one_on_the_multiples_of_its_step(
    reader: SqlLogReader, step_s: int, start: float | None, end: float | None
) -> None:
    whole = points(reader, 1, start, end)
    assert len(whole) > 300
    assert points(reader, step_s, start, end) == [point for point in whole if point[0] % step_s == 0]


def test_a_row_that_no_point_falls_on_is_never_decoded(
    reader: SqlLogReader, monkeypatch: pytest.MonkeyPatch
) -> None:
    decoded: list[bytes] = []

    def noted(encoded: bytes) -> PictureRecord:
        decoded.append(encoded)
        return decode(encoded)

    monkeypatch.setattr(tracks, "decode", noted)
    found = points(reader, 100)
    assert [point[0] for point in found] == [
        10_100,
        10_200,
        10_300,
        10_400,
        10_500,
        10_600,
        10_800,
        10_900,
        11_000,
    ]
    assert len(decoded) == 7  # one stands for three of them
