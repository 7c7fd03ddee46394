"""A real `firethread serve` process on a folder of its own, for the length of a benchmark."""

import contextlib
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path


@contextlib.contextmanager
def served(*options: str, environment: Mapping[str, str] | None = None) -> Iterator[tuple[str, int]]:
    """Serve, and yield host and port; afterwards process and folder are gone.

    Args:
        options: further options of `firethread serve`.
        environment: variables set for it beside ours.

    Raises:
        RuntimeError: it did not start.
    """
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "backend.cli", "serve", "--open", "--port", "0"]
        process = subprocess.Popen(  # noqa: S603 - our own command
            [*command, "--data", str(Path(folder) / "data"), *options],
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, **(environment or {})},
        )
        assert process.stdout is not None  # noqa: S101 - it is a pipe
        try:
            line = process.stdout.readline()
            if not line.startswith("ready http://"):
                raise RuntimeError(f"`firethread serve` did not start: {line!r}")
            host, port = line.removeprefix("ready http://").strip().rsplit(":", 1)
            yield host, int(port)
        finally:
            process.terminate()
            process.wait(20)
            process.stdout.close()
