"""A replay shows what `frame?t=` shows."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest
import sqlalchemy as sa

from backend.coordination.lease import Leases
from backend.live.past import frame_of, row_at
from backend.live.record import PictureRecord, RecordNode, encode
from backend.log.base import RecordedFrame
from backend.log.derived import SqlDerivedWriter
from backend.log.engine import make_engine, writing
from backend.log.incident import Clock, Incident
from backend.log.incidents import IncidentStore
from backend.log.migrate import prepare
from backend.log.read import SqlLogReader
from backend.replay.clock import ReplayClock
from backend.replay.player import Player

SECONDS = range(100, 160)
LATE = 130
"""From this second on the readings came 20 s late."""


@pytest.fixture
def engine(tmp_path: Path) -> Iterator[sa.Engine]:
    url = f"sqlite:///{tmp_path / 'firethread.db'}"
    prepare(url)
    engine = make_engine(url)
    yield engine
    engine.dispose()


def recorded(engine: sa.Engine, clock: Clock) -> Incident:
    incident = IncidentStore(engine).create("a walk", clock)
    epoch = Leases(lambda: writing(engine), "north").acquire(incident.id)
    assert epoch is not None
    rows = [
        RecordedFrame(
            second=second,
            seq=second - 99,
            received=second + (20.2 if second >= LATE else 0.2),
            record=encode(
                PictureRecord(
                    t=second - 0.1,
                    nodes=(
                        RecordNode(node="base", role="base", t=100.0, position_m=(0.0, 0.0, 0.0)),
                        RecordNode(
                            node="ff1",
                            role="responder",
                            t=min(second, 140) - 0.1,
                            position_m=(float(second), 0.0, 0.0),
                            covariance_m2=(1.0, 0.0, 0.0, 1.0, 0.0, 1.0),
                        ),
                    ),
                )
            ),
        )
        for second in SECONDS
        if second % 7
    ]
    SqlDerivedWriter(engine).save(incident.id, epoch, rows, None)
    return incident


def shown(messages: list[Any]) -> dict[str, Any]:
    """The picture after messages as a screen holds it."""
    nodes: dict[str, Any] = {}
    seq = 0
    for message in (msgspec.json.decode(msgspec.json.encode(one)) for one in messages if one is not None):
        nodes = {} if message["type"] == "frame" else nodes
        nodes |= {node["node"]: node for node in message["nodes"]}
        seq = message["seq"]
    return {"seq": seq, "nodes": nodes}


@pytest.mark.parametrize("clock_name", ["live", "recorded"])
def test_at_every_second_the_replay_shows_what_was_known_then(engine: sa.Engine, clock_name: Clock) -> None:
    incident, reader = recorded(engine, clock_name), SqlLogReader(engine)
    clock = ReplayClock(100.0, 159.0, 1.0, wall_s=0.0)
    player = Player(reader, incident, clock)
    messages = []
    for second in SECONDS:
        messages.append(player.message(second - 100.0))
        frame = msgspec.json.decode(
            msgspec.json.encode(frame_of(row_at(reader, incident, float(second)), incident, float(second)))
        )
        assert shown(messages) == {
            "seq": frame["seq"],
            "nodes": {node["node"]: node for node in frame["nodes"]},
        }


def test_what_came_late_was_not_seen_in_time(engine: sa.Engine) -> None:
    reader = SqlLogReader(engine)
    live, imported = recorded(engine, "live"), recorded(engine, "recorded")
    east = [frame_of(row_at(reader, i, 145.0), i, 145.0).nodes[1].position_m for i in (live, imported)]
    assert east == [(129.0, 0.0, 0.0), (145.0, 0.0, 0.0)]


def test_before_the_first_row_nothing_was_known(engine: sa.Engine) -> None:
    incident, reader = recorded(engine, "recorded"), SqlLogReader(engine)
    frame = frame_of(row_at(reader, incident, 50.0), incident, 50.0)
    assert (frame.seq, frame.t, frame.nodes) == (0, 50.0, ())


def test_a_seek_gives_a_whole_frame_and_then_deltas(engine: sa.Engine) -> None:
    incident, reader = recorded(engine, "recorded"), SqlLogReader(engine)
    clock = ReplayClock(100.0, 159.0, 1.0, wall_s=0.0)
    player = Player(reader, incident, clock)
    kinds = [_kind(player.message(1.0)), _kind(player.message(2.0))]
    clock.seek(150.0, 2.0)
    player.sought()
    kinds += [_kind(player.message(2.0)), _kind(player.message(3.0))]
    assert kinds == ["frame", "delta", "frame", "delta"]


def test_a_responder_ages_between_and_after_rows(engine: sa.Engine) -> None:
    incident, reader = recorded(engine, "recorded"), SqlLogReader(engine)
    clock = ReplayClock(140.0, 300.0, 1.0, wall_s=0.0)
    player = Player(reader, incident, clock)
    messages = [player.message(s / 2.0) for s in range(2, 250)]
    statuses = [node["status"] for m in messages if m for node in _nodes(m) if node["node"] == "ff1"]
    assert list(dict.fromkeys(statuses)) == ["live", "stale", "lost"]


def test_a_heartbeat_tells_where_the_replay_is(engine: sa.Engine) -> None:
    incident, reader = recorded(engine, "recorded"), SqlLogReader(engine)
    clock = ReplayClock(100.0, 159.0, 2.0, wall_s=0.0)
    player = Player(reader, incident, clock)
    player.message(1.0)
    beat = player.beat(1.0)
    assert (beat.t, beat.seq, beat.paused, beat.speed, beat.ended) == (102.0, 3, False, 2.0, False)
    assert player.beat(100.0).ended


def _kind(message: Any) -> str:
    kind: str = msgspec.json.decode(msgspec.json.encode(message))["type"]
    return kind


def _nodes(message: Any) -> list[dict[str, Any]]:
    nodes: list[dict[str, Any]] = msgspec.json.decode(msgspec.json.encode(message))["nodes"]
    return nodes
