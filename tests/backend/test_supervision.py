"""A child ends when its parent is gone, kindly where it listens; one that hangs is replaced."""

import asyncio
import itertools
import signal
import subprocess
import sys
import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from backend import supervision
from backend.supervision import Child

CHILD = textwrap.dedent(
    """
    import signal, sys, time
    from backend import supervision
    supervision.GRACE_S = 0.2
    signal.signal(signal.SIGTERM, {handler})
    supervision.end_with_parent()
    print("ready", flush=True)
    while True:
        time.sleep(0.05)
    """
)


@pytest.mark.parametrize(
    ("handler", "code"),
    [("lambda *_: sys.exit(7)", 7), ("signal.SIG_IGN", -signal.SIGKILL)],
    ids=["one that listens", "one that is too busy to listen"],
)
def test_a_child_whose_parent_is_gone_ends(handler: str, code: int) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", CHILD.format(handler=handler)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as child:
        assert child.stdout is not None
        assert child.stdin is not None
        assert child.stdout.readline() == b"ready\n"
        child.stdin.close()
        try:
            assert child.wait(20.0) == code
        finally:
            child.kill()


HANGS = textwrap.dedent(
    """
    import time
    from backend.supervision import goes_on
    for _ in range(4):
        goes_on(hangs_s=1.0)
        time.sleep(0.5)
    print("went on", flush=True)
    def stuck():
        while True:
            pass
    stuck()
    """
)


def test_a_process_that_no_longer_says_that_it_goes_on_ends_and_tells_where_it_hung() -> None:
    done = subprocess.run([sys.executable, "-c", HANGS], capture_output=True, timeout=20.0, check=False)
    assert (done.returncode, done.stdout) == (1, b"went on\n")
    assert b"in stuck" in done.stderr


async def pids_of(words: Callable[[int], int], so_many: int, tmp_path: Path) -> list[int]:
    """The first children that are seen under one supervisor."""
    seen: list[int] = []
    enough = asyncio.Event()

    def noted(pid: int) -> int:
        if pid not in seen:
            seen.append(pid)
        if len(seen) == so_many:
            enough.set()
        return words(pid)

    child = Child(["worker", "--supervised", "--data", str(tmp_path)], {}, noted)
    child.start()
    try:
        async with asyncio.timeout(30.0):
            await enough.wait()
            await asyncio.sleep(10 * supervision.SILENT_S)
    finally:
        await child.stop()
    return seen


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(supervision, "LOOK_EVERY_S", 0.02)
    monkeypatch.setattr(supervision, "SILENT_S", 0.1)
    monkeypatch.setattr(supervision, "FIRST_PAUSE_S", 0.01)


@pytest.mark.usefixtures("impatient")
def test_a_child_that_falls_silent_is_replaced_and_the_next_is_given_more_time(tmp_path: Path) -> None:
    looks: dict[int, int] = {}

    def spoke_once(pid: int) -> int:
        looks[pid] = looks.get(pid, -1) + 1
        return min(looks[pid], 1)

    first, second, *_ = asyncio.run(pids_of(spoke_once, 3, tmp_path))
    # Since it spoke: a process that is slow itself looks more rarely, and takes nobody's time away.
    silent, then = looks[first] - 1, looks[second] - 1
    assert silent >= round(supervision.SILENT_S / supervision.LOOK_EVERY_S)
    assert then > 1.5 * silent


@pytest.mark.usefixtures("impatient")
@pytest.mark.parametrize("said", [itertools.count(), itertools.repeat(0), itertools.repeat(7)])
def test_a_child_that_speaks_or_has_not_begun_to_is_left_alone(said: Iterator[int], tmp_path: Path) -> None:
    assert len(asyncio.run(pids_of(lambda _: next(said), 1, tmp_path))) == 1
