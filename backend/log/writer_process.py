"""The process that writes the log: whatever has come while it wrote is its next group.

It is a process because a thread would share the interpreter's lock with the decoding of requests: each of its
calls into the database ends in waiting for that lock, and with large batches that took longer than the disk.

Run by `backend.log.group_commit` as `python -m backend.log.writer_process FD`; ends when the socket does.
"""

import select
import signal
import socket
import sys
import time
from collections import deque
from collections.abc import Sequence
from contextlib import suppress

import sqlalchemy as sa
import structlog

from backend.errors import Problem
from backend.log.append import Outcome, append_group
from backend.log.base import LogUnwritable, NewBatch
from backend.log.engine import make_engine
from backend.log.writer_wire import Frames, parse_batch, written_frame
from backend.reports import to_standard_error

MAX_GROUP = 256
MAX_GROUP_BYTES = 16 * 1024 * 1024
RECEIVE_BYTES = 1024 * 1024

log = structlog.get_logger(__name__)


def run(link: socket.socket) -> None:
    """Say that it is there, and write groups until the other side is gone and all that came is written."""
    inbox = Inbox(link)
    url = inbox.url()
    if url is None:
        return
    engine = make_engine(url, checkpoints=True)
    with suppress(OSError):  # else nobody waits for the answer any more
        link.sendall(written_frame(0.0, []))
        while group := inbox.group():
            start = time.perf_counter()
            outcomes = write(engine, group)
            link.sendall(written_frame(time.perf_counter() - start, outcomes))
    engine.dispose()


def write(engine: sa.Engine, group: Sequence[NewBatch]) -> list[Outcome]:
    """Append a group; what goes wrong becomes the outcome of each batch concerned."""
    try:
        return append_group(engine, group)
    except LogUnwritable as problem:
        log.error("the log cannot be written", batches=len(group), detail=problem.detail)
        return [problem for _ in group]
    except Exception:
        # A batch that breaks the append must not take others with it: it is found by writing each alone.
        log.exception("appending a group failed", batches=len(group))
        if len(group) == 1:
            return [Problem("The batch could not be written to the log by a defect; it is not stored.")]
        return [outcome for batch in group for outcome in write(engine, [batch])]


class Inbox:
    """Batches as they come.

    Args:
        link: to the web process.
    """

    def __init__(self, link: socket.socket) -> None:
        self._link = link
        self._frames = Frames()
        self._waiting: deque[tuple[bytes, bytes]] = deque()
        self._open = True

    def url(self) -> str | None:
        """The URL that comes first; None if nothing comes."""
        while self._open and not self._waiting:
            self._receive()
        return self._waiting.popleft()[1].decode() if self._waiting else None

    def group(self) -> list[NewBatch]:
        """What has come, up to the bounds of a group; waits for one batch, and is empty at the end."""
        while self._open and not self._waiting:
            self._receive()
        group: list[NewBatch] = []
        size = 0
        while len(group) < MAX_GROUP and size < MAX_GROUP_BYTES:
            if not self._waiting:
                if not self._open or not select.select([self._link], [], [], 0)[0]:
                    break
                self._receive()
                continue
            head, body = self._waiting.popleft()
            size += len(body)
            group.append(parse_batch(head, body))
        return group

    def _receive(self) -> None:
        try:
            data = self._link.recv(RECEIVE_BYTES)
        except ConnectionResetError:
            data = b""
        self._open = bool(data)
        self._waiting.extend(self._frames.feed(data))


if __name__ == "__main__":
    # Ctrl-C and the like reach the whole family; this one ends when the web process lets go of it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    to_standard_error()
    run(socket.socket(fileno=int(sys.argv[1])))
