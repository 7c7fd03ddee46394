"""Every screen gets the newest state, and no screen waits for another."""

import asyncio
from collections.abc import Callable
from typing import Any

import msgspec
import pytest

from backend.live.channel import BEHIND_AFTER_S, Channel, Screen, Waiting
from backend.live.record import PictureRecord, RecordNode, encode
from backend.log.incident import Incident

Make = Callable[..., Incident]


class Tablet:
    """A screen's connection that may be slow."""

    def __init__(self) -> None:
        self.takes = True
        self.messages: list[dict[str, Any]] = []
        self.frames: list[bytes] = []

    def push(self, frame: bytes) -> bool:
        if not self.takes:
            return False
        self.frames.append(frame)
        self.messages.append(msgspec.json.decode(payload(frame)))
        return True

    def picture(self) -> dict[str, dict[str, Any]]:
        """What it shows: the frame, and the deltas on top of it."""
        nodes: dict[str, dict[str, Any]] = {}
        for message in self.messages:
            if message["type"] == "frame":
                nodes = {}
            if message["type"] in {"frame", "delta"}:
                nodes |= {node["node"]: node for node in message["nodes"]}
        return nodes


def payload(frame: bytes) -> bytes:
    assert frame[0] == 0x81
    start = {126: 4, 127: 10}.get(frame[1], 2)
    return frame[start:]


def at(east_m: float, t: float, others: int = 2) -> bytes:
    """A record in which one responder has moved and the others have not."""
    still = tuple(
        RecordNode(node=f"bc{i}", role="beacon", t=0.0, position_m=(0.0, 0.0, 0.0)) for i in range(others)
    )
    mover = RecordNode(
        node="ff1", role="responder", t=t, position_m=(east_m, 0.0, 0.0), covariance_m2=(1, 0, 0, 1, 0, 1)
    )
    return encode(PictureRecord(t=t, nodes=(*still, mover)))


def joined(channel: Channel) -> tuple[Tablet, Screen]:
    tablet = Tablet()
    screen = Screen(tablet)
    channel.show(0.0)
    channel.screens.add(screen)
    channel.catch_up(screen)
    return tablet, screen


@pytest.fixture
def channel(incident: Make) -> Channel:
    return Channel(incident(clock="recorded"))


def test_the_first_message_is_a_whole_frame_even_before_anything_is_known(channel: Channel) -> None:
    tablet, _ = joined(channel)
    assert [(m["type"], m["seq"], m["nodes"]) for m in tablet.messages] == [("frame", 0, [])]


def test_a_delta_holds_only_what_has_changed(channel: Channel) -> None:
    channel.take(1, at(0.0, 1.0))
    tablet, _ = joined(channel)
    channel.take(2, at(1.0, 2.0))
    channel.show(0.0)
    frame, delta = tablet.messages
    assert [node["node"] for node in frame["nodes"]] == ["bc0", "bc1", "ff1"]
    assert (delta["type"], delta["seq"], [node["node"] for node in delta["nodes"]]) == ("delta", 2, ["ff1"])


def test_all_screens_get_the_very_same_bytes(channel: Channel) -> None:
    one, _ = joined(channel)
    other, _ = joined(channel)
    channel.take(1, at(0.0, 1.0))
    channel.show(0.0)
    assert one.frames[-1] is other.frames[-1]


def test_nothing_is_said_where_nothing_has_changed(channel: Channel) -> None:
    channel.take(1, at(0.0, 1.0))
    tablet, _ = joined(channel)
    channel.show(0.0)
    channel.show(5.0)
    assert len(tablet.messages) == 1


def test_who_joins_where_nothing_changes_is_told_what_time_it_is(incident: Make) -> None:
    channel = Channel(incident(clock="live"))
    early, _ = joined(channel)
    channel.show(100.0)
    late = Screen(Tablet())
    channel.catch_up(late)
    assert isinstance(late.connection, Tablet)
    assert [message["clock_t"] for message in late.connection.messages] == [100.0]
    assert len(early.messages) == 1


def test_an_entry_that_changes_no_node_is_told_all_the_same(channel: Channel) -> None:
    channel.take(1, at(0.0, 1.0))
    tablet, _ = joined(channel)
    channel.take(2, at(0.0, 1.0))
    channel.show(0.0)
    assert (tablet.messages[-1]["seq"], tablet.messages[-1]["nodes"]) == (2, [])


def test_a_slow_screen_gets_the_newest_frame_and_the_others_miss_nothing(channel: Channel) -> None:
    slow, slow_screen = joined(channel)
    quick, _ = joined(channel)
    slow.takes = False
    for seq in range(1, 200):
        channel.take(seq, at(float(seq), float(seq)))
        channel.show(0.0)
    assert [m["seq"] for m in quick.messages] == list(range(200))
    slow.takes = True
    channel.catch_up(slow_screen)
    assert [(m["type"], m["seq"]) for m in slow.messages] == [("frame", 0), ("frame", 199)]
    assert slow.picture() == quick.picture()
    channel.take(200, at(0.0, 200.0))
    channel.show(0.0)
    assert slow.messages[-1]["type"] == "delta"
    assert slow.picture() == quick.picture()


def test_a_screen_that_has_everything_is_not_told_again(channel: Channel) -> None:
    tablet, screen = joined(channel)
    channel.catch_up(screen)
    assert len(tablet.messages) == 1


def test_an_older_picture_never_replaces_a_newer_one(channel: Channel) -> None:
    assert channel.take(5, at(5.0, 5.0))
    assert not channel.take(4, at(4.0, 4.0))
    tablet, _ = joined(channel)
    assert tablet.messages[0]["seq"] == 5


def test_a_node_that_is_gone_makes_a_whole_frame(channel: Channel) -> None:
    channel.take(1, at(0.0, 1.0, others=3))
    tablet, _ = joined(channel)
    channel.take(2, at(0.0, 1.0, others=1))
    channel.show(0.0)
    assert tablet.messages[-1]["type"] == "frame"
    assert set(tablet.picture()) == {"bc0", "ff1"}


def test_dots_go_stale_while_no_picture_comes(incident: Make) -> None:
    channel = Channel(incident(clock="live"))
    channel.take(1, at(0.0, 100.0))
    tablet, _ = joined(channel)
    statuses = []
    for server_t in (100.0, 105.0, 111.0, 161.0):
        channel.show(server_t)
        statuses.append(tablet.picture()["ff1"]["status"])
    assert statuses == ["live", "live", "stale", "lost"]


def test_a_heartbeat_tells_the_time_of_the_incident(channel: Channel) -> None:
    channel.take(3, at(0.0, 42.0))
    tablet, _ = joined(channel)
    channel.beat(1e9)
    assert tablet.messages[-1] == {"type": "heartbeat", "t": 42.0, "seq": 3}


def test_who_waits_for_an_entry_is_woken_by_it(channel: Channel) -> None:
    async def wait() -> tuple[bool, bool, bool]:
        waiting = asyncio.create_task(channel.folded(2, 5.0))
        await asyncio.sleep(0)
        channel.take(1, at(0.0, 1.0))
        await asyncio.sleep(0.01)
        early = waiting.done()
        channel.take(2, at(0.0, 2.0))
        return early, await waiting, await channel.folded(3, 0.01)

    assert asyncio.run(wait()) == (False, True, False)
    assert not channel.busy


def test_what_was_reported_and_is_long_not_in_the_picture_is_told_until_it_is(channel: Channel) -> None:
    def told(server_t: float) -> list[str]:
        return [notice.code for notice in channel.frame(server_t).notices]

    channel.take(3, at(0.0, 1.0))
    channel.waiting = Waiting(oldest=4, since_t=100.0, newest=6)
    assert told(100.0 + BEHIND_AFTER_S - 1) == []
    assert told(100.0 + BEHIND_AFTER_S + 1) == ["estimator_behind"]
    channel.take(5, at(0.0, 2.0))
    assert told(100.0 + BEHIND_AFTER_S + 1) == ["estimator_behind"]
    channel.take(6, at(0.0, 3.0))
    assert told(1000.0) == []


def test_a_screen_that_waits_is_told_as_soon_as_the_picture_is_behind(channel: Channel) -> None:
    channel.take(3, at(0.0, 1.0))
    tablet, _ = joined(channel)
    channel.waiting = Waiting(oldest=4, since_t=0.0, newest=4)
    channel.show(BEHIND_AFTER_S + 1)
    assert [notice["code"] for notice in tablet.messages[-1]["notices"]] == ["estimator_behind"]


def test_a_picture_that_is_ahead_of_a_clock_that_was_put_back_says_so(channel: Channel) -> None:
    channel.incident = channel.incident.model_copy(update={"clock": "live"})
    channel.take(3, at(0.0, 3700.0))
    told = [[notice.code for notice in channel.frame(now).notices] for now in (100.0, 3689.0, 3700.0)]
    assert told == [["clock_behind"], ["clock_behind"], []]
