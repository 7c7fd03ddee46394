"""Real `firethread serve` processes for tests: started, killed, started again on the same data and port."""

import contextlib
import os
import queue
import secrets
import signal
import socket
import sqlite3
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Self

import httpx2

READY_WITHIN_S = 120.0
"""A worker takes 5 s of a processor to begin: on one that many share, most of a minute."""
ANSWERED_WITHIN_S = 70.0
"""The server answers within 60 s, with a refusal if need be."""


def free_port() -> int:
    """A free port that nobody else is given meanwhile, not even while the server on it is down.

    The kernel gives what asks for port 0, and every outgoing connection, one from 32768 on.
    """
    while True:
        port = 20_000 + secrets.randbelow(12_768)
        with contextlib.suppress(OSError), socket.socket() as probe:
            probe.bind(("127.0.0.1", port))
            return port


class Server:
    """One deployment: a data folder and the processes on it.

    Args:
        data: its folder.
        options: further options of `firethread serve`.
        log: file that takes what the processes say on standard error.
    """

    access: tuple[str, ...] = ("--open",)

    def __init__(self, data: Path, options: Sequence[str] = (), log: Path | None = None) -> None:
        self.data = data
        self.options = list(options)
        self.log = log or data.parent / f"{data.name}.stderr"
        self.port = free_port()
        self.process: subprocess.Popen[str] | None = None

    @property
    def url(self) -> str:
        """Its HTTP address."""
        return f"http://127.0.0.1:{self.port}"

    def start(self) -> Self:
        """Start it and wait until it answers."""
        command = [sys.executable, "-m", "backend.cli", "serve", "--data", str(self.data), *self.access]
        command += ["--port", str(self.port), *self.options]
        with self.log.open("a") as errors:
            self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True)
        line = self._first_line()
        if not line.startswith("ready "):
            self.stop()
            raise AssertionError(f"the server did not start: {line!r}\n{self.log.read_text()[-3000:]}")
        return self

    def until_it_computes(self) -> Self:
        """Wait until an estimator worker is at work: what is posted from then on is shown at once."""
        with httpx2.Client(base_url=self.url) as http:
            eventually(lambda: http.get("/readyz").json()["worker"], within_s=READY_WITHIN_S)
        return self

    def _first_line(self) -> str:
        """The first line on standard output, or what kept it from coming."""
        assert self.process is not None
        assert self.process.stdout is not None
        lines: queue.Queue[str] = queue.Queue()
        stdout = self.process.stdout
        threading.Thread(target=lambda: lines.put(stdout.readline()), daemon=True).start()
        try:
            return lines.get(timeout=READY_WITHIN_S).strip()
        except queue.Empty:
            return f"no word within {READY_WITHIN_S} s"

    def worker_pids(self) -> list[int]:
        """The estimator workers that run as children of the web process."""
        return self._children(b"\0worker\0")

    def writer_pids(self) -> list[int]:
        """The log's writer, as a child of the web process."""
        return self._children(b"\0backend.log.writer_process\0")

    def _children(self, word: bytes) -> list[int]:
        assert self.process is not None
        children = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children")
        pids = [int(pid) for pid in children.read_text().split()] if children.exists() else []
        return [pid for pid in pids if word in Path(f"/proc/{pid}/cmdline").read_bytes()]

    def kill_worker(self) -> bool:
        """SIGKILL the worker, if one runs just now."""
        killed = False
        for pid in self.worker_pids():
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
                killed = True
        return killed

    def kill_web(self) -> None:
        """SIGKILL the web process."""
        assert self.process is not None
        self.process.kill()
        self.process.wait()
        if self.process.stdout is not None:
            self.process.stdout.close()

    def stop(self) -> None:
        """Stop it as an operator would."""
        if self.process is None:
            return
        self.process.terminate()
        try:
            self.process.wait(15)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        if self.process.stdout is not None:
            self.process.stdout.close()


@contextlib.contextmanager
def running(data: Path, *options: str) -> Iterator[Server]:
    """A server for the length of a block."""
    server = Server(data, options)
    try:
        yield server.start()
    finally:
        server.stop()


@contextlib.contextmanager
def stopped(pid: int, writes_to: Path | None = None) -> Iterator[None]:
    """A process that hangs for the length of a block.

    Args:
        pid: of the process.
        writes_to: a data folder's database that it does not write to just then: it would hold up all others.
    """
    os.kill(pid, signal.SIGSTOP)
    while writes_to is not None and _is_locked(writes_to):
        os.kill(pid, signal.SIGCONT)
        time.sleep(0.01)
        os.kill(pid, signal.SIGSTOP)
    try:
        yield
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGCONT)


def _is_locked(database: Path) -> bool:
    with contextlib.closing(sqlite3.connect(database, timeout=0.0, isolation_level=None)) as connection:
        try:
            connection.execute("BEGIN IMMEDIATE")
        except sqlite3.OperationalError:
            return True
        connection.execute("ROLLBACK")
    return False


class Post:
    """What a test does as a command post or gateway: the HTTP API in domain words.

    Args:
        url: address of the server.
    """

    def __init__(self, url: str) -> None:
        # No connection is kept: nothing is left open where a test only looks in.
        self.http = httpx2.Client(
            base_url=url + "/api/v1",
            timeout=ANSWERED_WITHIN_S,
            limits=httpx2.Limits(max_keepalive_connections=0),
        )

    def open_incident(self, name: str = "test", clock: str = "recorded", **fields: object) -> str:
        """Open an incident; its identifier."""
        response = self.http.post("/incidents", json={"name": name, "clock": clock, **fields})
        assert response.status_code == 201, response.text
        return str(response.json()["id"])

    def telemetry(
        self, incident: str, batch: str, readings: Sequence[object], gateway: str = "engine-7"
    ) -> dict[str, object]:
        """Post readings; the acknowledgement."""
        body = {"gateway": gateway, "batch": batch, "readings": list(readings)}
        response = self.http.post(f"/incidents/{incident}/telemetry", json=body)
        assert response.status_code == 202, response.text
        return dict(response.json())

    def frame(self, incident: str, **parameters: float) -> dict[str, object]:
        """The picture; with `min_seq` once that entry is folded, as long as the server waits at all."""
        if "min_seq" in parameters:
            parameters = {"timeout_s": 60.0} | parameters
        response = self.http.get(f"/incidents/{incident}/frame", params=parameters)
        assert response.status_code == 200, response.text
        return dict(response.json())

    def log(self, incident: str) -> list[bytes]:
        """The lines of the log."""
        response = self.http.get(f"/incidents/{incident}/log")
        assert response.status_code == 200, response.text
        return response.content.splitlines()

    def tracks(self, incident: str, **parameters: object) -> bytes:
        """The tracks as they came over the wire, to be compared bit for bit."""
        response = self.http.get(f"/incidents/{incident}/tracks", params=parameters)  # type: ignore[arg-type]
        assert response.status_code == 200, response.text
        return response.content


def close_all(server: Server) -> None:
    """Close every incident of a server that is active: calls for help in it are told on every screen."""
    with Post(server.url).http as http:
        for incident in http.get("/incidents", params={"state": "active"}).json():
            answer = http.patch(f"/incidents/{incident['id']}", json={"state": "closed"})
            assert answer.status_code == 200, answer.text


def quickest_s(ask: Callable[[], object], times: int = 5) -> float:
    """How long the quickest of some askings takes (s): a busy machine delays some, a long sum all of them."""
    took: list[float] = []
    for _ in range(times):
        began = time.monotonic()
        ask()
        took.append(time.monotonic() - began)
    return min(took)


def eventually(condition: object, within_s: float = 20.0, every_s: float = 0.05) -> object:
    """Wait until a callable gives something true; what it gave."""
    assert callable(condition)
    deadline = time.monotonic() + within_s
    while True:
        value = condition()
        if value:
            return value
        assert time.monotonic() < deadline, f"not within {within_s} s; last seen: {value!r}"
        time.sleep(every_s)
