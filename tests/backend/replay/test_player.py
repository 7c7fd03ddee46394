"""A replay shows what `frame?t=` shows."""

from typing import Any

import msgspec
import pytest
import sqlalchemy as sa

from backend.live.past import frame_of, row_at
from backend.log.incident import Clock
from backend.log.read import SqlLogReader
from backend.replay.clock import ReplayClock
from backend.replay.control import Control
from backend.replay.player import Player
from tests.backend.replay.walks import SECONDS, recorded


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
    player.obey(Control(seek=150.0), 2.0)
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
