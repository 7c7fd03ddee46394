"""Screens hear on, whatever the database or another incident does."""

import asyncio
import contextlib
import time

import pytest
import sqlalchemy as sa

from backend.coordination.base import Picture
from backend.live import hub as hub_module
from backend.live.hub import Hub
from backend.live.record import PictureRecord, RecordNode, encode
from backend.log.engine import make_engine
from backend.log.incident import Incident
from backend.log.incidents import IncidentStore
from backend.log.migrate import prepare
from backend.log.read import SqlLogReader


def record(t: float) -> bytes:
    return encode(PictureRecord(t=t, nodes=(RecordNode(node="ff1", role="responder", t=t),)))


class Heard:
    """A connection that takes everything.

    Attributes:
        frames: what it has taken.
    """

    def __init__(self) -> None:
        self.frames: list[bytes] = []
        self._more = asyncio.Event()

    def push(self, frame: bytes) -> bool:
        self.frames.append(frame)
        self._more.set()
        return True

    async def hears(self, more: int, within_s: float = 10.0) -> bool:
        """Whether so many come from now on."""
        wanted = len(self.frames) + more
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(within_s):
                while len(self.frames) < wanted:
                    self._more.clear()
                    await self._more.wait()
        return len(self.frames) >= wanted


def test_screens_hear_on_and_new_ones_are_let_in_while_the_database_does_not_answer(
    postgres_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hub_module, "BEAT_S", 0.05)
    monkeypatch.setattr(hub_module, "REFRESH_S", 0.05)
    monkeypatch.setattr(hub_module, "READ_WITHIN_S", 0.2)
    prepare(postgres_url)
    engine, other = make_engine(postgres_url), make_engine(postgres_url)
    incident = IncidentStore(engine).create("locked", "live").id

    async def go() -> tuple[bool, int]:
        hub = Hub(IncidentStore(engine), SqlLogReader(engine))
        hub.start()
        early, new = Heard(), Heard()
        await hub.join(incident, early)
        hub.take(Picture(incident, 1, record(0.0)))
        with other.begin() as connection:
            connection.execute(sa.text("LOCK TABLE incidents IN ACCESS EXCLUSIVE MODE"))
            await asyncio.sleep(0.2)  # by now the hub waits for the database
            heard = await early.hears(3)
            await hub.join(incident, new)
        await hub.stop()
        return heard, len(new.frames)

    heard, seen = asyncio.run(go())
    engine.dispose()
    other.dispose()
    assert heard
    assert seen >= 1


class HardlyAnswering(IncidentStore):
    """On a database that takes long."""

    takes_s = 0.0

    def get(self, incident: str) -> Incident:
        time.sleep(self.takes_s)
        return super().get(incident)


def test_who_joins_while_the_database_hardly_answers_hears_on_though_nobody_had_watched(
    engine: sa.Engine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hub_module, "BEAT_S", 0.01)
    monkeypatch.setattr(hub_module, "READ_WITHIN_S", 0.2)
    store = HardlyAnswering(engine)
    incident = store.create("nobody watched", "live").id

    async def go() -> bool:
        hub = Hub(store, SqlLogReader(engine))
        await hub.channel(incident)
        store.takes_s = 0.6
        hub.start()
        screen = Heard()
        await hub.join(incident, screen)
        heard = await screen.hears(5)
        await hub.stop()
        return heard

    assert asyncio.run(go())


def test_a_picture_that_cannot_be_shown_silences_no_other_incident(
    engine: sa.Engine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hub_module, "BEAT_S", 0.01)
    store = IncidentStore(engine)
    broken, sound = (store.create(name, "live").id for name in ("broken", "sound"))

    async def go() -> bool:
        hub = Hub(store, SqlLogReader(engine))
        channel, _ = await hub.join(broken, Heard())
        screen = Heard()
        await hub.join(sound, screen)
        channel.take(1, record(1.0)[:-1])
        channel.shown_t = 0.0
        hub.start()
        heard = await screen.hears(5)
        await hub.stop()
        return heard

    assert asyncio.run(go())
