"""The newest pictures of all incidents, and the screens that watch them."""

import asyncio
import math
import time

import structlog
from prometheus_client import Gauge

from backend.coordination.base import Picture
from backend.errors import Unavailable
from backend.live.channel import Channel, Connection, Screen, Waiting
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

READ_WITHIN_S = 2.0
"""A database that takes longer is away: what is known holds meanwhile."""

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
        self.failing: set[str] = set()
        self._tasks: list[asyncio.Task[None]] = []

    def start(self) -> None:
        """Begin to age and to beat."""
        # Apart, since a database may take long to answer, and dots age meanwhile.
        self._tasks = [asyncio.create_task(chore(), name="hub") for chore in (self._beat, self._refresh)]

    async def stop(self) -> None:
        """Stop."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def take(self, picture: Picture) -> None:
        """Take a picture from the worker, and show it."""
        if not readable(picture.record):
            log.error("a worker of another version sent a picture: update both", incident=picture.incident)
            return
        self._newest[picture.incident] = (time.monotonic(), picture)
        (self.failing.add if picture.failed else self.failing.discard)(picture.incident)
        _failing.set(len(self.failing))
        channel = self._channels.get(picture.incident)
        if channel is not None and _give(channel, picture) and channel.screens:
            channel.show(time.time())

    async def channel(self, incident: str) -> Channel:
        """The channel of an incident, with its settings as they are now.

        While the database is away, one that is held already keeps the settings that it has.

        Raises:
            NotFound: there is no such incident.
            Unavailable: the database failed, and nothing is held of the incident.
        """
        channel = self._channels.get(incident)
        try:
            async with asyncio.timeout(None if channel is None else READ_WITHIN_S):
                return await self._read_channel(incident)
        except (Unavailable, TimeoutError):
            if channel is None:
                raise
            # It may have been let go of meanwhile: who joined it then would never hear anything.
            return self._channels.setdefault(incident, channel)

    async def _read_channel(self, incident: str) -> Channel:
        known = await asyncio.to_thread(self._incidents.get, incident)
        channel = self._channels.get(incident)
        if channel is None:
            channel = await self._begin(known)
        channel.incident = known
        await self._read_on(channel)
        await self._look_what_waits(channel)
        # Nobody watched it meanwhile: it may have been let go of, and pictures pass it by.
        kept = self._channels.setdefault(incident, channel)
        if incident in self._newest:
            _give(kept, self._newest[incident][1])
        return kept

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
            Unavailable: the database failed, and nothing is held of the incident.
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
            _give(channel, self._newest[known.id][1])
        return self._channels.setdefault(known.id, channel)

    async def _read_on(self, channel: Channel) -> None:
        """Take the newest recorded picture where the worker has not told of it: the link may be down."""
        if channel.seq >= channel.incident.last_seq:
            return
        row = await asyncio.to_thread(self._reader.frame_at, channel.incident.id, FAR_FUTURE_T)
        if row is not None and row.seq > channel.seq and readable(row.record):
            channel.take(row.seq, row.record)

    async def _look_what_waits(self, channel: Channel) -> None:
        """Note which entries of the log are not in the picture; nothing comes to a closed incident."""
        incident, seq, waiting = channel.incident, channel.seq, channel.waiting
        if seq >= incident.last_seq or incident.state == "closed":
            channel.waiting = None
            return
        if waiting is not None and waiting.oldest > seq:
            channel.waiting = Waiting(waiting.oldest, waiting.since_t, incident.last_seq)
            return
        oldest = await asyncio.to_thread(lambda: next(self._reader.batches(incident.id, seq, 1), None))
        if oldest is not None:
            channel.waiting = Waiting(oldest.seq, oldest.received, incident.last_seq)

    async def _beat(self) -> None:
        while True:
            await asyncio.sleep(BEAT_S)
            self._forget()
            for channel in [channel for channel in self._channels.values() if channel.busy]:
                self._beat_once(channel)

    def _beat_once(self, channel: Channel) -> None:
        try:
            now = time.time()
            if abs(now - channel.shown_t) >= AGE_AFTER_S:
                channel.show(now)
            channel.beat(now)
        except Exception:
            # The screens of every other incident would take the silence for a lost server.
            log.exception("a heartbeat failed", incident=channel.incident.id)

    async def _refresh(self) -> None:
        while True:
            await asyncio.sleep(REFRESH_S)
            try:
                await self._refresh_once([channel for channel in self._channels.values() if channel.busy])
            except Unavailable as error:
                log.warning("settings cannot be read, the last ones hold", error=str(error))
            except Exception:
                log.exception("settings cannot be read, the last ones hold")

    async def _refresh_once(self, watched: list[Channel]) -> None:
        def read() -> list[Incident]:
            return [self._incidents.get(channel.incident.id) for channel in watched]

        for channel, incident in zip(watched, await asyncio.to_thread(read), strict=True):
            channel.incident = incident
            await self._read_on(channel)
            await self._look_what_waits(channel)

    def _forget(self) -> None:
        """Let go of pictures that nobody watches and of which nothing was heard for a while."""
        old = time.monotonic() - KEEP_S
        self._newest = {i: (at, picture) for i, (at, picture) in self._newest.items() if at > old}
        self._channels = {i: c for i, c in self._channels.items() if c.busy or i in self._newest}
        _watched.set(len(self._channels))


def _give(channel: Channel, picture: Picture) -> bool:
    """Have a channel take a worker's picture; False if it has a newer one."""
    return channel.take(picture.seq, picture.record, picture.row, picture.since_t)
