"""The newest pictures of all incidents, and the screens that watch them."""

import asyncio
import math
import time

import structlog
from prometheus_client import Gauge

from backend.coordination.base import Picture
from backend.errors import Unavailable
from backend.live.channel import Channel, Connection, Screen
from backend.live.record import readable
from backend.log.base import LogReader
from backend.log.incident import Incident
from backend.log.incidents import IncidentStore

BEAT_S = 1.0
"""Every screen hears something so often, and every picture is presented anew: dots age by themselves."""

AGE_AFTER_S = 0.4
"""A picture that was shown more recently has not aged enough to be told again."""

REFRESH_S = 2.0
"""Settings and levels of watched incidents are read again so often."""

KEEP_S = 300.0
"""A picture that nobody watches, and of which nothing is heard, is left to the database after so long."""

STORED_WITHIN_S = 2.0
STORED_POLL_S = 0.05
FAR_FUTURE_T = 1e11

log = structlog.get_logger(__name__)

_screens = Gauge("firethread_live_screens", "Open live sockets")
_failing = Gauge("firethread_live_failing", "Incidents whose estimator could not go on")
_watched = Gauge("firethread_live_incidents", "Incidents whose picture is held")


class Hub:
    """Gives pictures to screens; see `Channel`.

    Args:
        incidents: their settings and levels.
        reader: of the recorded rows: where a picture begins until the worker speaks.

    Attributes:
        failing: incidents whose estimator could not go on: their pictures stand still.
    """

    def __init__(self, incidents: IncidentStore, reader: LogReader) -> None:
        self._reader = reader
        self._incidents = incidents
        self._channels: dict[str, Channel] = {}
        self._newest: dict[str, tuple[float, Picture]] = {}
        self._refreshed_at = 0.0
        self.failing: set[str] = set()
        self._task: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Begin to age and to beat."""
        self._task = asyncio.create_task(self._beat(), name="hub")

    async def stop(self) -> None:
        """Stop."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)

    def take(self, picture: Picture) -> None:
        """Take a picture from the worker, and show it."""
        if not readable(picture.record):
            log.error("a worker of another version sent a picture: update both", incident=picture.incident)
            return
        self._newest[picture.incident] = (time.monotonic(), picture)
        (self.failing.add if picture.failed else self.failing.discard)(picture.incident)
        _failing.set(len(self.failing))
        channel = self._channels.get(picture.incident)
        if channel is not None and channel.take(picture.seq, picture.record, picture.row) and channel.screens:
            channel.show(time.time())

    async def channel(self, incident: str) -> Channel:
        """The channel of an incident, with its settings as they are now.

        Raises:
            NotFound: there is no such incident.
            LogUnreadable: the database failed.
        """
        known = await asyncio.to_thread(self._incidents.get, incident)
        channel = self._channels.get(incident)
        if channel is None:
            channel = await self._begin(known)
        channel.incident = known
        await self._read_on(channel)
        return channel

    async def stored(self, channel: Channel, t: float) -> None:
        """Wait until the rows up to a moment are stored, as far as they are final; not for long.

        The worker stores rows in groups: who asks for the past right after it was folded would miss some.

        Args:
            channel: of the incident.
            t: the moment, Unix seconds.

        Raises:
            LogUnreadable: the database failed.
        """
        if channel.row is None:
            return
        wanted = min(channel.row, t)
        deadline = time.monotonic() + STORED_WITHIN_S
        while time.monotonic() < deadline:
            newest = await asyncio.to_thread(self._reader.frame_at, channel.incident.id, FAR_FUTURE_T)
            if newest is not None and newest.second >= math.floor(wanted):
                return
            await asyncio.sleep(STORED_POLL_S)

    async def join(self, incident: str, connection: Connection) -> tuple[Channel, Screen]:
        """Have a connection see an incident, from a whole frame on.

        Raises:
            NotFound: there is no such incident.
            LogUnreadable: the database failed.
        """
        channel = await self.channel(incident)
        screen = Screen(connection)
        channel.show(time.time())
        channel.screens.add(screen)
        channel.catch_up(screen)
        _screens.inc()
        return channel, screen

    def leave(self, channel: Channel, screen: Screen) -> None:
        """A screen has gone."""
        channel.screens.discard(screen)
        _screens.dec()

    async def _begin(self, known: Incident) -> Channel:
        channel = Channel(known)
        await self._read_on(channel)
        if channel.seq < known.last_seq:
            # Entries without readings make no row; a stored state knows of them.
            snapshot = await asyncio.to_thread(self._reader.snapshot, known.id)
            channel.seq = max(channel.seq, 0 if snapshot is None else snapshot.seq)
        if known.id in self._newest:
            newest = self._newest[known.id][1]
            channel.take(newest.seq, newest.record, newest.row)
        return self._channels.setdefault(known.id, channel)

    async def _read_on(self, channel: Channel) -> None:
        """Take the newest recorded picture where the worker has not told of it: the link may be down."""
        if channel.seq >= channel.incident.last_seq:
            return
        row = await asyncio.to_thread(self._reader.frame_at, channel.incident.id, FAR_FUTURE_T)
        if row is not None and row.seq > channel.seq and readable(row.record):
            channel.take(row.seq, row.record)

    async def _beat(self) -> None:
        while True:
            await asyncio.sleep(BEAT_S)
            try:
                await self._beat_once()
            except Exception:
                # Every screen would take the silence for a lost server.
                log.exception("a heartbeat failed")

    async def _beat_once(self) -> None:
        watched = [channel for channel in self._channels.values() if channel.busy]
        if time.monotonic() - self._refreshed_at >= REFRESH_S:
            self._refreshed_at = time.monotonic()
            await self._refresh(watched)
            self._forget()
        for channel in watched:
            now = time.time()
            if abs(now - channel.shown_t) >= AGE_AFTER_S:
                channel.show(now)
            channel.beat(now)

    async def _refresh(self, watched: list[Channel]) -> None:
        def read() -> list[Incident]:
            return [self._incidents.get(channel.incident.id) for channel in watched]

        try:
            for channel, incident in zip(watched, await asyncio.to_thread(read), strict=True):
                channel.incident = incident
                await self._read_on(channel)
        except Unavailable as error:
            log.warning("settings cannot be read, the last ones hold", error=str(error))

    def _forget(self) -> None:
        """Let go of pictures that nobody watches and of which nothing was heard for a while."""
        old = time.monotonic() - KEEP_S
        self._newest = {i: (at, picture) for i, (at, picture) in self._newest.items() if at > old}
        self._channels = {i: c for i, c in self._channels.items() if c.busy or i in self._newest}
        _watched.set(len(self._channels))
