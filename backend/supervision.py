"""Child processes that are started again when they end or hang, and that never outlive their parent."""

import asyncio
import contextlib
import faulthandler
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence

import structlog

log = structlog.get_logger()

FIRST_PAUSE_S = 0.2
LONGEST_PAUSE_S = 5.0
SETTLED_S = 10.0
"""A child that lived this long counts as healthy: the next start comes at once."""
GRACE_S = 5.0

SILENT_S = 20.0
"""A child that has spoken and says nothing for so long hangs, perhaps with the database's lock in hand."""

LONGEST_SILENT_S = 160.0
"""Compiled loops may hold the interpreter: after each child that was killed for its silence the next one is
given twice the time, so that one that only computes is not killed for ever."""

LOOK_EVERY_S = 1.0

HANGS_S = 180.0
"""A process that has not said for so long that it goes on ends itself: later than who supervises it would end
it, and than a database that answers nothing is given up."""


class Child:
    """One supervised child: a `firethread` subcommand of this same installation.

    Args:
        arguments: the subcommand and its options.
        environment: variables set for it beside ours.
        words: how much a process has said so far, by its pid; None: nothing is expected to be said.
    """

    def __init__(
        self,
        arguments: Sequence[str],
        environment: Mapping[str, str],
        words: Callable[[int], int] | None = None,
    ) -> None:
        self.name = arguments[0]
        self._command = [sys.executable, "-m", "backend.cli", *arguments]
        self._environment = {**os.environ, **environment}
        self._words = words
        self._silent_s = SILENT_S
        self._task: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Begin to keep it running."""
        self._task = asyncio.create_task(self._keep_running(), name=f"supervise {self.name}")

    async def stop(self) -> None:
        """End it, first kindly."""
        if self._task is not None:
            self._task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._task

    async def _keep_running(self) -> None:
        loop = asyncio.get_running_loop()
        pause_s = FIRST_PAUSE_S
        while True:
            # The child reads its standard input to its end: when we die, however suddenly, it ends too.
            process = await asyncio.create_subprocess_exec(
                *self._command, env=self._environment, stdin=asyncio.subprocess.PIPE
            )
            began = loop.time()
            try:
                code = await self._end_of(process)
            except asyncio.CancelledError:
                await _end(process)
                raise
            pause_s = FIRST_PAUSE_S if loop.time() - began > SETTLED_S else min(2 * pause_s, LONGEST_PAUSE_S)
            log.warning("child ended, it is started again", child=self.name, code=code, pause_s=pause_s)
            await asyncio.sleep(pause_s)

    async def _end_of(self, process: asyncio.subprocess.Process) -> int:
        """Wait until a child has ended, and kill it if it hangs; its exit code.

        Only once it has ended is there another: what it holds is then given up, and it writes no more.
        """
        if self._words is None:
            return await process.wait()
        others = before = self._words(process.pid)  # said by whoever had its number earlier
        silent_s = 0.0
        while True:
            with contextlib.suppress(TimeoutError):
                return await asyncio.wait_for(process.wait(), LOOK_EVERY_S)
            # Counted by looks and not by the clock: this process may have been stopped itself.
            words = self._words(process.pid)
            silent_s = silent_s + LOOK_EVERY_S if others < words == before else 0.0
            before = words
            if silent_s >= self._silent_s:
                log.error("child hangs and is killed", child=self.name, silent_s=silent_s)
                self._silent_s = min(2 * self._silent_s, LONGEST_SILENT_S)
                with contextlib.suppress(ProcessLookupError):
                    process.kill()
                return await process.wait()


async def _end(process: asyncio.subprocess.Process) -> None:
    """Ask a process to end, then insist."""
    if process.stdin is not None:
        process.stdin.close()
    with contextlib.suppress(ProcessLookupError):
        process.terminate()
    try:
        await asyncio.wait_for(process.wait(), GRACE_S)
    except TimeoutError:
        process.kill()
        await process.wait()


def end_with_parent() -> None:
    """Have this process end when whoever supervises it closes our standard input, by dying or by will."""

    def watch() -> None:
        while sys.stdin.buffer.read(4096):
            pass
        os.kill(os.getpid(), signal.SIGTERM)
        # A worker that still compiles would hear it minutes later, beside the one that takes its place.
        time.sleep(GRACE_S)
        os.kill(os.getpid(), signal.SIGKILL)

    threading.Thread(target=watch, name="end with parent", daemon=True).start()


def goes_on(hangs_s: float = HANGS_S) -> None:
    """Say that this process goes on: it ends, and tells where each thread stands, unless that is said again.

    Whoever runs it starts it again. No thread of Python's is needed for it, which a loop would hold up.

    Args:
        hangs_s: within so long (s).
    """
    faulthandler.dump_traceback_later(hangs_s, exit=True)
