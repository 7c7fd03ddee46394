"""Child processes that are started again when they end, and that never outlive their parent."""

import asyncio
import contextlib
import os
import signal
import sys
import threading
import time
from collections.abc import Mapping, Sequence

import structlog

log = structlog.get_logger()

FIRST_PAUSE_S = 0.2
LONGEST_PAUSE_S = 5.0
SETTLED_S = 10.0
"""A child that lived this long counts as healthy: the next start comes at once."""
GRACE_S = 5.0


class Child:
    """One supervised child: a `firethread` subcommand of this same installation.

    Args:
        arguments: the subcommand and its options.
        environment: variables set for it beside ours.
    """

    def __init__(self, arguments: Sequence[str], environment: Mapping[str, str]) -> None:
        self.name = arguments[0]
        self._command = [sys.executable, "-m", "backend.cli", *arguments]
        self._environment = {**os.environ, **environment}
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
                code = await process.wait()
            except asyncio.CancelledError:
                await _end(process)
                raise
            pause_s = FIRST_PAUSE_S if loop.time() - began > SETTLED_S else min(2 * pause_s, LONGEST_PAUSE_S)
            log.warning("child ended, it is started again", child=self.name, code=code, pause_s=pause_s)
            await asyncio.sleep(pause_s)


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
