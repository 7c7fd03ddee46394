"""`firethread bench fanout`: frames to a thousand screens, beside a bare broadcaster of the same bytes."""

import asyncio
import contextlib
import math
import secrets
import socket
import subprocess
import sys
import time
from collections.abc import Iterator

import msgspec
import uvloop

from backend.bench.http import Client
from backend.bench.server import served
from backend.coordination.base import Picture
from backend.coordination.worker_link import WorkerLink
from backend.live import record
from backend.live.record import PictureRecord, RecordNode
from backend.settings import LINK_TOKEN_VARIABLE

SCREENS = 1_000
FRAME_BYTES = 20_000
NODES = 38
"""So many changed nodes make a delta of about `FRAME_BYTES`."""

RATES_HZ = (5.0, 10.0, 20.0, 40.0, 80.0)
WARM_S = 1.0
COUNTED_S = 3.0
GOAL = 0.5


class Delivered(msgspec.Struct, frozen=True):
    """What a server delivered at one rate.

    Attributes:
        rate_hz: frames a second that it was given.
        frames: frames a second that reached screens.
        screens_cpu: share of a processor that the screens took.
    """

    rate_hz: float
    frames: float
    screens_cpu: float


def run() -> None:
    """Measure both servers at rising rates, and print the table."""
    bare = _bare()
    ours = _ours()
    print(f"{SCREENS} sockets, {FRAME_BYTES} bytes a frame; frames delivered a second")
    print(f"{'frames/s given':>16}{'firethread':>14}{'bare uvloop':>14}{'ratio':>8}{'screens cpu':>14}")
    for one, other in zip(ours, bare, strict=True):
        print(
            f"{one.rate_hz:16g}{one.frames:14.0f}{other.frames:14.0f}{one.frames / other.frames:8.2f}"
            f"{one.screens_cpu:7.2f}{other.screens_cpu:7.2f}"
        )
    best, bare_best = max(d.frames for d in ours), max(d.frames for d in bare)
    ratio = best / bare_best
    print(f"{'at saturation':>16}{best:14.0f}{bare_best:14.0f}{ratio:8.2f}")
    print(f"goal: at least {GOAL:g}: {'met' if ratio >= GOAL else 'NOT met'}")


def _bare() -> list[Delivered]:
    command = [sys.executable, "-m", "backend.bench.broadcaster", str(FRAME_BYTES)]
    with _child(command) as broadcaster:
        port = int(_line(broadcaster))

        def give(rate_hz: float) -> None:
            assert broadcaster.stdin is not None  # noqa: S101 - it is a pipe
            broadcaster.stdin.write(f"{rate_hz}\n")
            broadcaster.stdin.flush()

        with _screens("127.0.0.1", port, "/") as screens:
            delivered = []
            for rate_hz in RATES_HZ:
                give(rate_hz)
                delivered.append(_count(screens, rate_hz))
            give(0.0)
    return delivered


def _ours() -> list[Delivered]:
    with socket.create_server(("127.0.0.1", 0)) as free:
        link: tuple[str, int] = free.getsockname()
    token = secrets.token_urlsafe(16)
    options = ("--no-worker", "--link", f"{link[0]}:{link[1]}")
    with served(*options, environment={LINK_TOKEN_VARIABLE: token}) as (host, port):
        incident = uvloop.run(_open_incident(host, port))
        path = f"/api/v1/incidents/{incident}/live"
        with _screens(host, port, path) as screens:
            return uvloop.run(_publish(link, token, incident, screens))


async def _open_incident(host: str, port: int) -> str:
    client = await Client.to(host, port)
    incident: str = (await client.post("/api/v1/incidents", b'{"name":"fanout","clock":"recorded"}'))["id"]
    client.close()
    return incident


async def _publish(
    link: tuple[str, int], token: str, incident: str, screens: "subprocess.Popen[str]"
) -> list[Delivered]:
    """Send pictures as a worker does, at each rate, each one different in every node."""
    connected = asyncio.Event()
    worker = WorkerLink(link, token, "bench", on_connect=connected.set)
    worker.start()
    await asyncio.wait_for(connected.wait(), 10.0)
    delivered = []
    seq = 0
    try:
        for rate_hz in RATES_HZ:
            counting = asyncio.create_task(asyncio.to_thread(_count, screens, rate_hz))
            began, given = time.perf_counter(), 0
            while not counting.done():
                seq, given = seq + 1, given + 1
                worker.publish(Picture(incident, seq, record.encode(_picture(seq))))
                await asyncio.sleep(began + given / rate_hz - time.perf_counter())
            delivered.append(await counting)
    finally:
        await worker.close()
    return delivered


def _picture(seq: int) -> PictureRecord:
    """A picture whose delta has about `FRAME_BYTES` bytes."""
    value = math.sin(seq) / 3.0
    node = RecordNode(
        node="",
        role="responder",
        t=1000.0 + seq,
        position_m=(value, value, value),
        covariance_m2=(1.0 + value, value, value, 1.0 + value, value, 1.0 + value),
        heading_rad=value,
        heading_sigma_rad=value,
        speed_mps=value,
        callsign="E7-2",
        crew="E7",
    )
    return PictureRecord(
        t=1000.0 + seq,
        nodes=tuple(msgspec.structs.replace(node, node=f"ff{i:03d}") for i in range(NODES)),
    )


@contextlib.contextmanager
def _screens(host: str, port: int, path: str) -> Iterator["subprocess.Popen[str]"]:
    """A process with all the sockets."""
    command = [sys.executable, "-m", "backend.bench.screens", host, str(port), path, str(SCREENS)]
    with _child(command) as screens:
        if _line(screens) != "ready":
            raise RuntimeError("the screens could not connect")
        yield screens


@contextlib.contextmanager
def _child(command: list[str]) -> Iterator["subprocess.Popen[str]"]:
    """A process that is spoken with in lines."""
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)  # noqa: S603 - ours
    try:
        yield process
    finally:
        process.terminate()
        process.wait(10)


def _line(process: "subprocess.Popen[str]") -> str:
    assert process.stdout is not None  # noqa: S101 - it is a pipe
    return process.stdout.readline().strip()


def _count(screens: "subprocess.Popen[str]", rate_hz: float) -> Delivered:
    """What the screens get while a rate is given."""
    time.sleep(WARM_S)
    bytes_before, cpu_before = _ask(screens)
    began = time.perf_counter()
    time.sleep(COUNTED_S)
    bytes_after, cpu_after = _ask(screens)
    seconds = time.perf_counter() - began
    return Delivered(
        rate_hz, (bytes_after - bytes_before) / FRAME_BYTES / seconds, (cpu_after - cpu_before) / seconds
    )


def _ask(screens: "subprocess.Popen[str]") -> tuple[int, float]:
    assert screens.stdin is not None  # noqa: S101 - it is a pipe
    screens.stdin.write("\n")
    screens.stdin.flush()
    received, cpu_s = _line(screens).split()
    return int(received), float(cpu_s)
