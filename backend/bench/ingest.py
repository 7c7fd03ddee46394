"""`firethread bench ingest`: how fast telemetry is taken, beside what the machine could do at best.

Everything runs on the same cores, in turns: the limit alone; then the real server with the load beside it;
then, beside the same load, the plain FastAPI application of `backend.bench.declared`.
"""

import contextlib
import os
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import httpx2
import msgspec

from backend.bench.declared import metadata
from backend.bench.load import CONNECTIONS, Result, Task
from backend.bench.server import served
from backend.bench.telemetry import GATEWAYS, batch_bodies
from backend.log.batch import decode_batch
from backend.log.engine import make_engine

SIZES = (10, 100, 1_000)
TARGETS = {10: 0.25, 100: 0.50, 1_000: 0.80}
ROUNDS = 5
BATCHES_A_SYNC = 32
LIMIT_S = 1.0
RIVAL_WAIT_S = 20.0
HEAD = """\
{} connections, {} gateways, bodies of mixed readings; median of {} rounds; server and load on the same cores
limit: one process decodes the same bodies, writes them, and syncs every {} batches
declared: FastAPI with declared pydantic models, a row a reading through SQLAlchemy

readings      limit  firethread  readings/s  ratio    min    max  target  declared  ratio"""


def run(rounds: int = ROUNDS) -> None:
    """Measure, and print the table.

    Args:
        rounds: how often each is measured, in turns.
    """
    with (
        tempfile.TemporaryDirectory() as folder,
        served("--no-worker") as (host, port),
        rival(folder) as other,
    ):
        incident = httpx2.post(
            f"http://{host}:{port}/api/v1/incidents", json={"name": "bench ingest", "clock": "live"}
        ).json()["id"]
        path = f"/api/v1/incidents/{incident}/telemetry"
        print(HEAD.format(CONNECTIONS, GATEWAYS, rounds, BATCHES_A_SYNC))
        first = 0
        for size in SIZES:
            limits, ours, theirs = [], [], []
            for _ in range(rounds):
                limits.append(limit(size, Path(folder) / "limit"))
                ours.append(load(Task(host, port, path, size, first)))
                theirs.append(load(Task("127.0.0.1", other, path, size, first)))
                first += 10_000_000
            _row(size, limits, ours, theirs)


def _row(size: int, limits: list[float], ours: list[float], theirs: list[float]) -> None:
    ratios = [mine / best for mine, best in zip(ours, limits, strict=True)]
    declared = [rate / best for rate, best in zip(theirs, limits, strict=True)]
    middle = statistics.median
    print(
        f"{size:>8} {middle(limits):>8.0f}/s {middle(ours):>9.0f}/s {middle(ours) * size:>11.0f} "
        f"{middle(ratios):>6.2f} {min(ratios):>6.2f} {max(ratios):>6.2f} {TARGETS[size]:>7.2f} "
        f"{middle(theirs):>7.0f}/s {middle(declared):>6.2f}",
        flush=True,
    )


def limit(size: int, path: Path) -> float:
    """Batches a second that one process decodes and writes durably, with nothing around it.

    Args:
        size: readings in a batch.
        path: file that is written.
    """
    bodies = batch_bodies(size, time.time())
    done, start = 0, time.perf_counter()
    with path.open("wb") as file:
        while time.perf_counter() - start < LIMIT_S:
            for _ in range(BATCHES_A_SYNC):
                body = bodies[done % len(bodies)]
                decode_batch(body)
                file.write(body)
                done += 1
            file.flush()
            os.fsync(file.fileno())
        rate = done / (time.perf_counter() - start)
    path.unlink()
    return rate


def load(task: Task) -> float:
    """Batches a second that a server acknowledges.

    Raises:
        RuntimeError: it answered with something else than 202.
    """
    done = subprocess.run(
        [sys.executable, "-m", "backend.bench.load"],
        input=msgspec.json.encode(task),
        capture_output=True,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(done.stderr.decode()[-2000:])
    result = msgspec.json.decode(done.stdout, type=Result)
    return result.batches / result.seconds


@contextlib.contextmanager
def rival(folder: str) -> Iterator[int]:
    """Serve the plain application; yields its port.

    Args:
        folder: for its database.
    """
    url = f"sqlite:///{folder}/declared.db"
    engine = make_engine(url)
    metadata.create_all(engine)
    engine.dispose()
    with socket.create_server(("127.0.0.1", 0), backlog=512) as listener:
        # Connections wait in the listening socket until the process has come up and takes them.
        command = [
            sys.executable,
            "-m",
            "uvicorn",
            "backend.bench.declared:app",
            "--fd",
            str(listener.fileno()),
        ]
        process = subprocess.Popen(  # noqa: S603 - our own application
            [*command, "--no-access-log", "--log-level", "warning"],
            env={**os.environ, "FIRETHREAD_BENCH_DATABASE": url},
            pass_fds=[listener.fileno()],
        )
        port: int = listener.getsockname()[1]
    try:
        httpx2.get(f"http://127.0.0.1:{port}/", timeout=RIVAL_WAIT_S)
        yield port
    finally:
        process.terminate()
        process.wait(20)
