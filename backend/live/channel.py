"""One incident as its screens see it: the newest picture, presented once for all of them."""

import asyncio
from typing import Protocol

import msgspec

from backend.live.frame import DeltaMessage, Frame, FrameMessage, FrameNotice, HeartbeatMessage, message
from backend.live.past import told_at
from backend.live.presentation import now_of, present
from backend.live.push_protocol import text_frame
from backend.live.record import EMPTY, PictureRecord, decode
from backend.log.incident import Incident

BEHIND_AFTER_S = 5.0
"""An entry of the log that is not in the picture for longer is told of: an alarm may be in it."""

AHEAD_S = 10.0
"""Nothing is newer than when it came: a picture that is, has been made before the clock was put back."""

NOT_YET = "What was last reported is not in this picture yet: the worker is behind, or there is none."
PUT_BACK = "The server's clock was put back since this picture was made: check it, and the gateways' clocks."

_encode = msgspec.json.Encoder().encode


class Connection(Protocol):
    """What a channel needs of a screen's connection."""

    def push(self, frame: bytes) -> bool:
        """Write a ready-made frame; False if the last one has not been taken yet."""


class Waiting(msgspec.Struct, frozen=True):
    """What the log holds and the picture does not.

    Attributes:
        oldest: the first such entry.
        since_t: when it came, Unix seconds.
        newest: the last such entry.
    """

    oldest: int
    since_t: float
    newest: int


class Screen:
    """A client of a channel.

    Args:
        connection: where to write.

    Attributes:
        version: of the presentation that it has; 0: none yet.
    """

    __slots__ = ("connection", "version")

    def __init__(self, connection: Connection) -> None:
        self.connection = connection
        self.version = 0


class Channel:
    """The newest picture of an incident, and the screens that see it.

    Each presentation has a version. A screen that has the one before gets the delta; any other gets the
    whole frame: so a slow one finds the newest state and never a backlog.

    Args:
        incident: its settings, levels, clock.

    Attributes:
        incident: as newly known.
        seq: newest log entry in the picture.
        row: newest second whose row is final, stored or about to be; None: all of them are stored.
        since_t: since when the picture has been shown, Unix seconds; None: it is not known.
        screens: who sees it.
        shown_t: when it was last presented, Unix seconds.
        waiting: what the log was last seen to hold that the picture did not.
    """

    def __init__(self, incident: Incident) -> None:
        self.incident = incident
        self.seq = 0
        self.row: int | None = None
        self.since_t: float | None = None
        self.screens: set[Screen] = set()
        self.shown_t = 0.0
        self.waiting: Waiting | None = None
        self._encoded: bytes | None = None
        self._record: PictureRecord = EMPTY
        self._version = 0
        self._frame: Frame | None = None
        self._nodes: dict[str, bytes] = {}
        self._whole: bytes | None = None
        self._folded: list[tuple[int, asyncio.Future[None]]] = []

    def take(self, seq: int, encoded: bytes, row: int | None = None, since_t: float | None = None) -> bool:
        """Take a picture; False if a newer one is here already.

        Args:
            seq: newest log entry in it.
            encoded: the record.
            row: newest second whose row is final, stored or about to be.
            since_t: since when it has been shown, Unix seconds.
        """
        if seq < self.seq:
            return False
        self.seq, self.row, self.since_t = seq, row, since_t
        self._encoded = encoded
        for wanted, waiting in self._folded:
            if wanted <= seq and not waiting.done():
                waiting.set_result(None)
        return True

    async def folded(self, seq: int, timeout_s: float) -> bool:
        """Wait until the picture holds a log entry; False if it does not in time."""
        if self.seq >= seq:
            return True
        waiting: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._folded.append((seq, waiting))
        try:
            async with asyncio.timeout(timeout_s):
                await waiting
        except TimeoutError:
            return False
        finally:
            self._folded = [entry for entry in self._folded if entry[1] is not waiting]
        return True

    @property
    def busy(self) -> bool:
        """Someone watches, or waits for an entry to be folded."""
        return bool(self.screens or self._folded)

    @property
    def record(self) -> PictureRecord:
        """The newest picture."""
        if self._encoded is not None:
            self._record, self._encoded = decode(self._encoded), None
        return self._record

    def now(self, server_t: float) -> float:
        """The moment that is now for the incident (Unix s)."""
        return now_of(self.incident, self.record, server_t)

    def frame(self, server_t: float) -> Frame:
        """The frame of this moment."""
        frame = present(self.record, self.seq, self.now(server_t), self.incident)
        notices = list(frame.notices)
        if self.behind(server_t):
            notices.append(FrameNotice(code="estimator_behind", t=frame.t, text=NOT_YET, node=None))
        if frame.newest_t is not None and frame.newest_t > frame.t + AHEAD_S:
            notices.append(FrameNotice(code="clock_behind", t=frame.t, text=PUT_BACK, node=None))
        return msgspec.structs.replace(frame, notices=tuple(notices))

    def behind(self, server_t: float) -> bool:
        """Whether an entry of the log has not been in the picture for too long."""
        waiting = self.waiting
        return (
            waiting is not None and self.seq < waiting.newest and server_t - waiting.since_t > BEHIND_AFTER_S
        )

    def past_frame(self, t: float) -> Frame | None:
        """The frame of a moment since which nothing has come; None where something may have.

        Args:
            t: the moment, Unix seconds.
        """
        if self.since_t is None or t < self.since_t:
            return None
        told = told_at(self.incident, t) if self.incident.clock == "live" else self.incident
        return present(self.record, self.seq, t, told)

    def show(self, server_t: float) -> None:
        """Present the picture anew, and give every screen what has changed."""
        self.shown_t = server_t
        frame = self.frame(server_t)
        nodes = {node.node: _encode(node) for node in frame.nodes}
        before, had = self._frame, self._nodes
        changed = [node for node in frame.nodes if had.get(node.node) != nodes[node.node]]
        if (
            before is not None
            and not changed
            and _rest(before) == _rest(frame)
            and had.keys() == nodes.keys()
        ):
            # Who comes now is told the time that it is, not when something has changed.
            self._frame, self._whole = frame, None
            return
        self._frame, self._nodes, self._whole = frame, nodes, None
        self._version += 1
        delta = None
        if before is not None and had.keys() <= nodes.keys():
            delta = text_frame(
                _encode(message(DeltaMessage, frame, [msgspec.Raw(nodes[node.node]) for node in changed]))
            )
        for screen in self.screens:
            if delta is not None and screen.version == self._version - 1:
                if screen.connection.push(delta):
                    screen.version = self._version
            else:
                self.catch_up(screen)

    def catch_up(self, screen: Screen) -> None:
        """Give a screen the newest whole frame, unless it has it, or has not taken the last message yet."""
        if screen.version == self._version or self._frame is None:
            return
        if self._whole is None:
            self._whole = text_frame(
                _encode(
                    message(FrameMessage, self._frame, [msgspec.Raw(node) for node in self._nodes.values()])
                )
            )
        if screen.connection.push(self._whole):
            screen.version = self._version

    def beat(self, server_t: float) -> None:
        """Give every screen a sign of life."""
        beat = text_frame(_encode(HeartbeatMessage(t=self.now(server_t), seq=self.seq)))
        for screen in self.screens:
            screen.connection.push(beat)


def _rest(frame: Frame) -> tuple[object, ...]:
    """What of a frame does not stand in its nodes, but for the moment."""
    return frame.seq, frame.alarms, frame.notices, frame.set_aside, frame.clocks
