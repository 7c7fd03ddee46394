"""A child ends when its parent is gone, kindly where it listens."""

import signal
import subprocess
import sys
import textwrap

import pytest

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
