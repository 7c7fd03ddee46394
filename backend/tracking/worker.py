"""The estimator worker: a process that follows the log of every incident and publishes pictures."""

import asyncio
import signal
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import structlog

from backend.coordination.base import Answer, Query
from backend.coordination.lease import RENEW_S, Leases
from backend.coordination.worker_link import WorkerLink
from backend.errors import Unavailable
from backend.interpreter import tune_for_serving
from backend.log.base import StaleEpoch
from backend.log.derived import SqlDerivedWriter
from backend.log.engine import make_engine, writing
from backend.log.read import SqlLogReader
from backend.supervision import goes_on
from backend.tracking.follower import Follower
from backend.tracking.heads import Head, heads
from estimator.warm import warm_up

POLL_S = 0.5
"""The log is looked at so often even if no wake-up comes: the link may be down."""

AGAIN_AFTER_S = 1.0
"""An incident that another worker holds, or that could not be begun, is tried again after so long: one that
is told to stop gives its leases back within that time, and whoever takes its place goes on at once."""

STOP_WITHIN_S = 4.0

COMPUTE_THREADS = 2
"""So many incidents are folded at a time, by turns of the interpreter: one whose steps take seconds (hundreds
of people, a gateway gone mad) must not hold all others back."""

log = structlog.get_logger(__name__)


def run_worker(
    database_url: str, link_address: tuple[str, int] | None, token: str, holder: str, shown_hz: float
) -> None:
    """Follow all incidents until told to stop by SIGTERM or SIGINT.

    The entry point must have set OPENBLAS_NUM_THREADS and OMP_NUM_THREADS to 1 before numpy is imported.

    Args:
        database_url: SQLAlchemy URL of the log.
        link_address: host and port of the web process's link; None: nobody is told, the rows are stored.
        token: the deployment's link token.
        holder: this worker's name: one that is started again under it takes its incidents at once, unless the
            process that had them still runs.
        shown_hz: how often a picture may be published, per incident.
    """
    asyncio.run(Worker(database_url, link_address, token, holder, shown_hz, goes_on).run())


class Worker:
    """All incidents of one process; see `run_worker`.

    Args:
        looked: is called whenever the database has been asked and has answered, or was found to be away.
    """

    def __init__(
        self,
        database_url: str,
        link_address: tuple[str, int] | None,
        token: str,
        holder: str,
        shown_hz: float,
        looked: Callable[[], None] | None = None,
    ) -> None:
        self._looked = looked
        self._engine = make_engine(database_url)
        self._reader = SqlLogReader(self._engine)
        self._writer = SqlDerivedWriter(self._engine)
        self._leases = Leases(lambda: writing(self._engine), holder)
        self._link = WorkerLink(link_address, token, holder, on_connect=self._show_all_again)
        self._compute = ThreadPoolExecutor(COMPUTE_THREADS, thread_name_prefix="estimator")
        self._shown_hz = shown_hz
        self._followers: dict[str, Follower] = {}
        self._tasks: dict[str, asyncio.Task[None]] = {}
        self._not_before: dict[str, float] = {}
        self._answering: set[asyncio.Task[None]] = set()
        self._stop = asyncio.Event()
        self._away = False

    async def run(self) -> None:
        """Follow all incidents until told to stop."""
        loop = asyncio.get_running_loop()
        for number in (signal.SIGTERM, signal.SIGINT):
            loop.add_signal_handler(number, self._stop.set)
        chores = [asyncio.create_task(chore()) for chore in (self._poll, self._renew, self._listen)]
        stopped = asyncio.create_task(self._stop.wait())
        # A chore never ends by itself: if one does, it is by a defect, and the supervisor starts us again.
        await asyncio.wait([*chores, stopped], return_when=asyncio.FIRST_COMPLETED)
        for chore in chores:
            if chore.done():
                chore.result()
            chore.cancel()
        for follower in self._followers.values():
            follower.stop()
        if self._tasks:
            await asyncio.wait(self._tasks.values(), timeout=STOP_WITHIN_S)
        await self._link.close()
        self._compute.shutdown(wait=False, cancel_futures=True)
        self._engine.dispose()

    async def _poll(self) -> None:
        # Incidents are taken up only after this: the compiled loops are loaded, or made.
        loop = asyncio.get_running_loop()
        await loop.run_in_executor(self._compute, _warm_up)
        # Whoever asks whether a worker is there hears of one that can compute.
        self._link.start()
        while True:
            await self._look()
            if self._looked is not None:
                self._looked()
            await asyncio.sleep(POLL_S)

    async def _look(self) -> None:
        """See which incidents there are to be followed."""
        try:
            for head in await asyncio.to_thread(heads, self._engine, list(self._tasks)):
                self._hear_of(head)
        except Unavailable as error:
            if not self._away:  # it is looked for twice a second, for hours perhaps
                log.warning("the database is away", error=str(error))
            self._away = True
        else:
            if self._away:
                log.info("the database is there again")
            self._away = False

    def _hear_of(self, head: Head) -> None:
        now = asyncio.get_running_loop().time()
        if head.incident in self._tasks:
            if not self._followers[head.incident].hear_of(head):
                self._followers[head.incident].stop()
        elif now >= self._not_before.get(head.incident, 0.0):
            follower = Follower(
                head,
                self._reader,
                self._writer,
                self._leases,
                self._compute,
                self._link.publish,
                self._shown_hz,
            )
            self._followers[head.incident] = follower
            self._tasks[head.incident] = asyncio.create_task(self._follow(head.incident, follower))

    async def _follow(self, incident: str, follower: Follower) -> None:
        again_after_s = AGAIN_AFTER_S
        try:
            await follower.run()
            if follower.failed:
                # Its lease is kept and its picture stands; a restart tries it again, and other settings do.
                await follower.stopped()
            if follower.epoch is not None:
                again_after_s = 0.0
        except StaleEpoch as error:
            log.warning("another worker has taken the incident", incident=incident, error=str(error))
        except Unavailable as error:
            log.warning("the database is away", incident=incident, error=str(error))
        except Exception:
            # A defect in one incident must not stop the others; what was stored is where it begins again.
            log.exception("following ended by a defect", incident=incident)
        finally:
            self._not_before[incident] = asyncio.get_running_loop().time() + again_after_s
            del self._tasks[incident], self._followers[incident]

    async def _renew(self) -> None:
        while True:
            await asyncio.sleep(RENEW_S)
            held = [(name, one.epoch) for name, one in self._followers.items() if one.epoch is not None]
            if not held:
                continue
            try:
                lost = await asyncio.to_thread(self._leases.renew, held)
            except Unavailable as error:
                log.warning("leases cannot be renewed", error=str(error))
                continue
            for incident in lost & self._tasks.keys():
                log.warning("another worker has taken the incident", incident=incident)
                self._tasks[incident].cancel()

    async def _listen(self) -> None:
        while True:
            unknown = False
            for message in await self._link.receive(POLL_S):
                if isinstance(message, Query):
                    task = asyncio.create_task(self._answer(message))
                    self._answering.add(task)
                    task.add_done_callback(self._answering.discard)
                elif message.incident in self._followers:
                    self._followers[message.incident].hear(message.seq)
                else:
                    unknown = True
            if unknown:
                await self._look()

    async def _answer(self, query: Query) -> None:
        follower = self._followers.get(query.incident)
        if follower is None:
            self._link.publish(Answer(query.number, found=False, followed=False))
        else:
            self._link.publish(await follower.ask(query))

    def _show_all_again(self) -> None:
        for follower in self._followers.values():
            follower.show_again()


def _warm_up() -> None:
    warm_up()
    tune_for_serving()
