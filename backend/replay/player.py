"""One replay: the messages that show the past as it was shown then."""

from backend.live.frame import DeltaMessage, Frame, FrameMessage, HeartbeatMessage, message
from backend.live.past import record_of, row_at, told_at
from backend.live.presentation import present
from backend.live.record import EMPTY
from backend.log.base import LogReader, RecordedFrame
from backend.log.incident import Incident
from backend.replay.clock import ReplayClock
from backend.replay.control import Control, apply


class Player:
    """Makes the messages of a replay; what it shows at a moment is what `frame?t=` shows.

    Args:
        reader: of the recorded rows.
        incident: which incident.
        clock: where the replay is.
    """

    def __init__(self, reader: LogReader, incident: Incident, clock: ReplayClock) -> None:
        self._reader = reader
        self._incident = incident
        self._clock = clock
        self._shown: Frame | None = None
        self._row: RecordedFrame | None = None
        self._record = EMPTY

    def obey(self, control: Control, wall_s: float) -> None:
        """Do what a viewer asks; after a jump the next message is a whole frame.

        Args:
            control: what it asks.
            wall_s: the wall time now (s).
        """
        apply(control, self._clock, wall_s)
        if control.seek is not None:
            self._shown = None

    def message(self, wall_s: float) -> FrameMessage | DeltaMessage | None:
        """What the viewer does not have yet at a wall time; None if nothing has changed.

        Raises:
            LogUnreadable: the database failed.
            UnknownRecord: another version wrote the rows.
        """
        t = self._clock.now(wall_s)
        if self._shown is not None and self._shown.t == t:
            return None
        frame = self._frame_at(t)
        before, self._shown = self._shown, frame
        had = {} if before is None else {node.node: node for node in before.nodes}
        if before is None or not had.keys() <= {node.node for node in frame.nodes}:
            return message(FrameMessage, frame, frame.nodes)
        changed = tuple(node for node in frame.nodes if had.get(node.node) != node)
        if not changed and (before.seq, before.alarms, before.notices) == (
            frame.seq,
            frame.alarms,
            frame.notices,
        ):
            return None
        return message(DeltaMessage, frame, changed)

    def _frame_at(self, t: float) -> Frame:
        row = row_at(self._reader, self._incident, t)
        if row is None or self._row is None or (row.second, row.seq) != (self._row.second, self._row.seq):
            self._row, self._record = row, record_of(row)
        told = told_at(self._incident, t, row)
        return present(self._record, 0 if row is None else row.seq, t, told)

    def beat(self, wall_s: float) -> HeartbeatMessage:
        """A sign of life, with where the replay is."""
        return HeartbeatMessage(
            t=self._clock.now(wall_s),
            seq=0 if self._shown is None else self._shown.seq,
            paused=self._clock.paused,
            speed=self._clock.speed,
            ended=self._clock.ended(wall_s),
        )
