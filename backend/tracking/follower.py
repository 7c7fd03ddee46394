"""One incident followed: its log read, folded, published and stored."""

import asyncio
import contextlib
import time
from collections.abc import Iterator
from concurrent.futures import Executor

import structlog

from backend.coordination.base import Answer, Query
from backend.coordination.lease import Leases
from backend.live import record
from backend.live.record import PictureRecord
from backend.log.base import DerivedWriter, LogReader, LogUnreadable, RecordedFrame, Snapshot
from backend.tracking.answering import answer
from backend.tracking.computing import Computing, EstimatorFailed
from backend.tracking.course import Course, Step
from backend.tracking.fair_turns import for_a_while
from backend.tracking.fold import IncidentFold
from backend.tracking.heads import Head
from backend.tracking.publication import Publication, Publish
from backend.tracking.storing import Keeper

IDLE_S = 2.0
"""After so long without news the state is stored, and what was folded in a hurry is told without one."""

LEAVE_S = 120.0
"""After so long without news an incident is left; the next reading brings the worker back to it."""

LONGEST_REST_S, RETRY_S = 0.5, 1.0

AHEAD_AFTER_S = 0.3
"""What was folded in a hurry is folded without one meanwhile, where nothing has come for so long: a gateway
that sends what it held back sends more often."""

log = structlog.get_logger(__name__)


class Follower:
    """Follows one incident until it is closed, idle for long, or taken by another worker.

    Args:
        head: the incident.
        reader: of the log.
        writer: of rows and states.
        leases: of this worker.
        compute: threads for all folding; an incident is in one of them at a time.
        publish: sends a picture or an answer to the web process.
        shown_hz: how often a picture may be published.

    Attributes:
        epoch: of the lease; None while it is not held.
        failed: the estimator could not fold an entry; the picture stands still.
    """

    def __init__(
        self,
        head: Head,
        reader: LogReader,
        writer: DerivedWriter,
        leases: Leases,
        compute: Executor,
        publish: Publish,
        shown_hz: float,
    ) -> None:
        self.epoch: int | None = None
        self.failed = False
        self._head = head
        self._reader = reader
        self._writer = writer
        self._leases = leases
        self._computing = Computing(compute)
        self._publication = Publication(head.incident, publish, shown_hz)
        self._news = asyncio.Event()
        self._news_seq = head.last_seq
        self._news_at = time.monotonic()
        self._stopping = asyncio.Event()
        self._course: Course
        self._keeper: Keeper
        self._storing: asyncio.Task[bool] | None = None
        self._recorded: tuple[RecordedFrame, int] | None = None

    def hear(self, seq: int) -> None:
        """The log has grown."""
        if seq > self._news_seq:
            self._news_seq, self._news_at = seq, time.monotonic()
            self._news.set()

    def hear_of(self, head: Head) -> bool:
        """The incident as newly known; False if its estimator failed, and is told otherwise: begin anew."""
        if self.failed and head.stretch > self._course.made_with.stretch:
            return False
        if head.closed != self._head.closed or head.stretch != self._head.stretch:
            self._news.set()
        self._head = head
        self.hear(head.last_seq)
        return True

    def show_again(self) -> None:
        """Publish the newest picture once more: the web process may have missed it."""
        self._publication.again()
        self._news.set()

    def stop(self) -> None:
        """Store everything and end."""
        self._stopping.set()
        self._news.set()

    async def stopped(self) -> None:
        """Wait until it is told to stop."""
        await self._stopping.wait()

    async def run(self) -> None:
        """Follow.

        Raises:
            StaleEpoch: another worker holds the incident now.
            LogUnreadable, LogUnwritable: the database failed before anything was folded.
        """
        self.epoch = await asyncio.to_thread(self._leases.acquire, self._head.incident)
        if self.epoch is None:
            return
        self._course, settled = await self._restore()
        self._keeper = Keeper(self._writer, self._head.incident, self.epoch, settled, self._course.at)
        try:
            await self._follow()
        except EstimatorFailed:
            # Whatever the estimator makes of one incident's readings, the other incidents go on.
            log.exception("the estimator failed", incident=self._head.incident, seq=self._fold.seq)
            self.failed = True
            self._publication.stand_still(self._fold.seq)
            await self._keeper.save(None)
            return
        await asyncio.to_thread(self._leases.release, self._head.incident, self.epoch)

    async def ask(self, query: Query) -> Answer:
        """The answer to a question about two nodes."""
        if not hasattr(self, "_course"):
            return Answer(query.number, found=False, followed=False)
        return await self._computing.run(answer, self._fold, query)

    @property
    def _fold(self) -> IncidentFold:
        return self._course.fold

    @property
    def _behind(self) -> bool:
        """Something is to be folded, by all that was heard."""
        seq, stretch = self._course.at
        return self._news_seq > seq or self._head.stretch > stretch

    async def _follow(self) -> None:
        heard_at = time.monotonic()
        while True:
            self._news.clear()
            if await self._advance():
                heard_at = time.monotonic()
            await self._show()
            quiet_s = time.monotonic() - heard_at
            if not self._behind and self._publication.lacks(self._fold.seq):
                await self._computing.estimate(self._fold.prepare)
                await self._show()
            ended = self._head.closed or quiet_s >= LEAVE_S
            more = await self._settle_ahead()
            if not self._behind and (ended or quiet_s >= IDLE_S):
                await self._tell_in_full()
            behind = self._behind
            if (ended and not behind) or self._stopping.is_set():
                await self._show(last=True)
                if await self._settle() or self._stopping.is_set():
                    return
            else:
                await self._keep(caught_up=not behind, idle=quiet_s >= IDLE_S)
            if (not behind and not more) or self._keeper.full:
                await self._rest()

    async def _settle_ahead(self) -> bool:
        """While nothing waits, fold a little of what was folded in a hurry; False: nothing more for now."""
        busy = self._behind or self._stopping.is_set() or self._publication.lacks(self._fold.seq)
        if busy or time.monotonic() < self._news_at + AHEAD_AFTER_S:
            return False
        return await self._computing.estimate(self._fold.settling)

    async def _tell_in_full(self) -> None:
        """Tell without a hurry what was folded in one, unless more comes meanwhile."""
        while await self._computing.estimate(self._fold.settling):
            if self._behind or self._stopping.is_set():
                return
        if await self._computing.estimate(self._fold.settle):
            self._publication.again()

    async def _restore(self) -> tuple[Course, int | None]:
        """The course as it was stored, or from the start; and up to which second rows stay as shown."""
        incident, live = self._head.incident, self._head.live
        span = await asyncio.to_thread(self._reader.frame_span, incident)
        snapshot = await asyncio.to_thread(self._reader.snapshot, incident)
        course = await self._computing.run(Course.begin, self._reader, incident, live, snapshot)
        return course, None if span is None else span[1]

    async def _advance(self) -> bool:
        """Fold one block of the log, if there is one and what waits to be stored leaves room."""
        if not self._behind or self._keeper.full:
            return False
        before = self._course.at
        try:
            block = await asyncio.to_thread(self._course.read)
        except LogUnreadable as error:
            log.warning("the log cannot be read", incident=self._head.incident, error=str(error))
            await asyncio.sleep(RETRY_S)
            return False
        work = self._folding(self._course.steps(block))
        while await self._computing.estimate(for_a_while, work):
            await self._show()
            await self._keep(caught_up=False)
            if self._course.passing and self._stopping.is_set():
                return False  # the whole log may be folded anew: whoever goes on begins that again
        if not block:
            self._news_seq = self._fold.seq  # what was heard of is not there: the next poll tells
        if self._course.at[1] != before[1]:
            self._publication.again()
        return self._course.at != before

    def _folding(self, steps: Iterator[Step]) -> Iterator[bool]:
        """Fold; after each step, tell whether what was begun is folded whole."""
        for row, whole in steps:
            if row is not None:
                self._keeper.take(row, put_back=self._fold.clock.ahead_s > 0)
                # The entry that is being folded is not whole in it.
                self._recorded = row, min(row.seq, self._fold.seq - 1)
            yield whole

    async def _show(self, *, last: bool = False) -> None:
        """Publish the picture if it is new and the last one was long enough ago, or no other will follow."""
        fold = self._fold
        behind = (self._behind or not fold.whole) and not last
        recorded, self._recorded = self._recorded, None
        if self._course.passing:
            return
        if behind and recorded is not None:
            row, seq = recorded
            self._publication.show_recorded(row, seq, fold.row, fold.since_t_of(row))
        if not fold.whole or not self._publication.lacks(fold.seq):
            return
        if self._publication.due_s(behind=behind) > 0 and not last:
            return
        self._publication.begin()
        picture, encoded = await self._computing.estimate(self._encoded)
        self._publication.show(fold.seq, fold.row, fold.since_t, picture, encoded)

    def _encoded(self) -> tuple[PictureRecord, bytes]:
        picture = self._fold.picture()
        return picture, record.encode(picture)

    async def _keep(self, *, caught_up: bool, idle: bool = False) -> None:
        """Have what waits stored, and the state from time to time, without waiting for the disk.

        Raises:
            StaleEpoch: another worker holds the incident now.
        """
        if self._storing is not None:
            if not self._storing.done():
                return
            self._storing.result()
            self._storing = None
        if not self._fold.whole or self._keeper.rests_s(soon=caught_up) > 0:
            return
        snapshot = None
        if not self._course.passing and self._keeper.wants_snapshot(self._course.at, idle=idle and caught_up):
            snapshot = await self._computing.estimate(self._snapshot)
        if snapshot is not None or not self._keeper.empty:
            self._storing = asyncio.create_task(self._keeper.save(snapshot))
            # Where the following ends before it does, nobody asks for its exception any more.
            self._storing.add_done_callback(lambda done: done.cancelled() or done.exception())

    def _snapshot(self) -> Snapshot:
        """The state, and the row of the current second with it: the rows then hold all that is known."""
        fold, made_with = self._fold, self._course.made_with
        row = fold.last_row()
        if row is not None:
            self._keeper.take(row, put_back=fold.clock.ahead_s > 0)
        return Snapshot(seq=fold.seq, state=fold.state(), made_with=made_with.encoded())

    async def _settle(self) -> bool:
        """Store everything now; False where the database cannot be written."""
        if self._storing is not None:
            await self._storing
            self._storing = None
        if self._keeper.snapshot_at == self._course.at and self._keeper.empty:
            return True
        snapshot = None if self._course.passing else await self._computing.estimate(self._snapshot)
        return await self._keeper.save(snapshot)

    async def _rest(self) -> None:
        """Wait for news, or until something is due."""
        due_s = self._publication.due_s() if self._publication.lacks(self._fold.seq) else LONGEST_REST_S
        if not self._keeper.empty and (self._storing is None or self._storing.done()):
            due_s = min(due_s, self._keeper.rests_s(soon=True))
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self._news.wait(), min(max(due_s, 0.001), LONGEST_REST_S))
