import socket
import threading
from collections.abc import Iterator

import pytest
import sqlalchemy as sa
import structlog

from backend.errors import Problem
from backend.log.writer_process import MAX_GROUP, Inbox, run, write
from backend.log.writer_wire import LENGTHS, Frames, batch_frame, parse_written
from backend.reports import to_standard_error
from tests.backend.log.batches import MakeBatch, seqs


@pytest.fixture
def plain_reports() -> Iterator[None]:
    to_standard_error()
    yield
    structlog.reset_defaults()


@pytest.mark.usefixtures("plain_reports")
def test_a_batch_that_breaks_the_append_does_not_take_others_with_it(
    engine: sa.Engine, batch: MakeBatch
) -> None:
    first, broken, last = write(engine, [batch("1"), batch("2", gateway="\ud800", body=b"{}"), batch("3")])
    assert seqs([first, last]) == [1, 2]
    assert type(broken) is Problem


def test_what_has_come_meanwhile_is_one_group(batch: MakeBatch) -> None:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        for i in range(MAX_GROUP + 10):
            theirs.sendall(b"".join(batch_frame(batch(str(i)))))
        inbox = Inbox(ours)
        assert [one.batch for one in inbox.group()] == [str(i) for i in range(MAX_GROUP)]
        assert len(inbox.group()) == 10
        theirs.close()
        assert inbox.group() == []


def test_the_writer_writes_what_came_before_the_other_side_went(url: str, batch: MakeBatch) -> None:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        thread = threading.Thread(target=run, args=(theirs,))
        thread.start()
        ours.sendall(LENGTHS.pack(0, len(url)) + url.encode())
        for i in range(5):
            ours.sendall(b"".join(batch_frame(batch(str(i)))))
        ours.shutdown(socket.SHUT_WR)
        thread.join(30)
        ours.settimeout(5)
        frames = Frames()
        written = [parse_written(payload) for payload, _ in frames.feed(ours.recv(1_000_000))]
    seqs = [appended.seq for one in written for appended, _ in one.outcomes if appended is not None]
    assert seqs == [1, 2, 3, 4, 5]
