"""What a viewer asks while a message is under way."""

import asyncio
import threading
from typing import Any

import msgspec
import sqlalchemy as sa
from fastapi import WebSocket

from backend.log.base import RecordedFrame
from backend.log.read import SqlLogReader
from backend.replay.clock import ReplayClock
from backend.replay.player import Player
from backend.replay.socket import play
from tests.backend.replay.walks import recorded

SOUGHT_T = 150.0


class SlowReader(SqlLogReader):
    """Holds every read of a row until it is let go on."""

    def __init__(self, engine: sa.Engine) -> None:
        super().__init__(engine)
        self.is_reading, self.go_on = threading.Event(), threading.Event()

    def frame_at(self, incident: str, t: float, received_by: float | None = None) -> RecordedFrame | None:
        self.is_reading.set()
        assert self.go_on.wait(20)
        return super().frame_at(incident, t, received_by)


def test_who_seeks_while_a_message_is_made_gets_a_whole_frame_of_that_moment(engine: sa.Engine) -> None:
    incident, reader = recorded(engine, "recorded"), SlowReader(engine)
    player = Player(reader, incident, ReplayClock(100.0, 159.0, 1.0, wall_s=0.0))

    async def viewer() -> dict[str, Any]:
        asked: asyncio.Queue[dict[str, Any]] = asyncio.Queue()
        shown: asyncio.Queue[dict[str, Any]] = asyncio.Queue()

        async def send(event: Any) -> None:
            if event["type"] == "websocket.send":
                await shown.put(msgspec.json.decode(event["text"]))

        socket = WebSocket({"type": "websocket"}, asked.get, send)
        asked.put_nowait({"type": "websocket.connect"})
        await socket.accept()
        playing = asyncio.create_task(play(socket, player))
        await asyncio.to_thread(reader.is_reading.wait, 20)
        asked.put_nowait({"type": "websocket.receive", "text": f'{{"seek": {SOUGHT_T}, "pause": true}}'})
        # Whoever listens has taken it by the time the loop comes round again.
        await asyncio.sleep(0.2)
        assert asked.empty()
        reader.go_on.set()
        async with asyncio.timeout(20):
            while (message := await shown.get())["type"] == "heartbeat" or message["t"] != SOUGHT_T:
                pass
        asked.put_nowait({"type": "websocket.disconnect"})
        await playing
        return message

    message = asyncio.run(viewer())
    assert message["type"] == "frame"
    assert [node["node"] for node in message["nodes"]] == ["base", "ff1"]
