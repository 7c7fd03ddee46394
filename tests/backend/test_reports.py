import subprocess
import sys

REPORT = """
import structlog
from backend.reports import to_standard_error
to_standard_error()
try:
    1 / 0
except ZeroDivisionError:
    structlog.get_logger().exception("it failed", place="here")
"""


def test_what_happens_is_said_on_standard_error_with_a_plain_traceback() -> None:
    done = subprocess.run([sys.executable, "-c", REPORT], capture_output=True, text=True, check=True)
    assert done.stdout == ""
    assert "it failed" in done.stderr
    assert "place=here" in done.stderr
    assert "ZeroDivisionError: division by zero" in done.stderr
    assert len(done.stderr.splitlines()) < 10
