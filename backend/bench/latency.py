"""`firethread bench latency`: from a gateway's POST to the delta at a screen."""

import asyncio
import bisect
import time
from typing import cast

import msgspec
import uvloop
from websockets.asyncio.client import ClientConnection, connect

from backend.bench.crews import BREADCRUMBS, GATEWAYS, RATE_HZ, RESPONDERS, Crews, body
from backend.bench.http import Client
from backend.bench.server import served

WARM_S = 5.0
COUNTED_S = 30.0
P50_GOAL_MS, P99_GOAL_MS = 100.0, 300.0
LAST_WITHIN_S = 10.0
BARE_ROUNDS = 1000


class Posted(msgspec.Struct, frozen=True):
    """A batch that was posted.

    Attributes:
        sent: when its POST began (s).
        answered: when its receipt was here (s).
        seq: its place in the log.
    """

    sent: float
    answered: float
    seq: int


class Seen(msgspec.Struct):
    """Of a message from the live socket, only what counts here."""

    type: str
    seq: int = 0


_decode = msgspec.json.Decoder(Seen).decode


def run() -> None:
    """Measure, and print the table."""
    with served() as (host, port):
        posted, shown = uvloop.run(_drive(host, port))
    size = len(body(0, 0, Crews(0.0).report(0, 1.0)))
    to_screen = latencies_ms(posted, shown)
    rows = {
        "POST to delta at a screen": to_screen,
        "POST to its receipt, durable": [1000.0 * (one.answered - one.sent) for one in posted],
        f"{size} bytes over bare TCP, there and on to a second connection": uvloop.run(_bare(size)),
    }
    readings = sum(len(Crews(0.0).report(gateway, 1.0)) for gateway in range(GATEWAYS)) * RATE_HZ
    print(
        f"{RESPONDERS} responders, {BREADCRUMBS} breadcrumbs, {RATE_HZ:g} Hz for {COUNTED_S:g} s by "
        f"{GATEWAYS} gateways: {GATEWAYS * RATE_HZ:g} batches and {readings:g} readings a second"
    )
    print(f"{'':<62}{'p50 ms':>9}{'p99 ms':>9}{'max ms':>9}")
    for name, values in rows.items():
        print(f"{name:<62}{percentile(values, 50):9.1f}{percentile(values, 99):9.1f}{max(values):9.1f}")
    met = percentile(to_screen, 50) < P50_GOAL_MS and percentile(to_screen, 99) < P99_GOAL_MS
    print(f"goal: p50 < {P50_GOAL_MS:g} ms, p99 < {P99_GOAL_MS:g} ms: {'met' if met else 'NOT met'}")


def percentile(values: list[float], percent: float) -> float:
    """The smallest value that so many percent of `values` do not exceed."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(len(ordered) * percent / 100.0))]


def latencies_ms(posted: list[Posted], shown: list[tuple[float, int]]) -> list[float]:
    """From each POST to the first message that holds its batch (ms).

    Args:
        posted: what was posted.
        shown: when messages came (s) and the newest log entry in each, in order.
    """
    seqs = [seq for _, seq in shown]
    return [1000.0 * (shown[bisect.bisect_left(seqs, one.seq)][0] - one.sent) for one in posted]


async def _drive(host: str, port: int) -> tuple[list[Posted], list[tuple[float, int]]]:
    """Post as gateways do while a screen watches."""
    first = await Client.to(host, port)
    incident = (await first.post("/api/v1/incidents", b'{"name":"latency","clock":"live"}'))["id"]
    path = f"/api/v1/incidents/{incident}"
    crews = Crews(time.time())
    await first.post(f"{path}/telemetry", body(0, 0, crews.introductions()))
    shown: list[tuple[float, int]] = []
    posted: list[Posted] = []
    async with connect(f"ws://{host}:{port}{path}/live", max_size=None, compression=None) as screen:
        last: asyncio.Future[int] = asyncio.get_running_loop().create_future()
        watching = asyncio.create_task(_watch(screen, shown, last))
        began = time.perf_counter()
        gateways = [
            _gateway(await Client.to(host, port), f"{path}/telemetry", number, crews, began, posted)
            for number in range(GATEWAYS)
        ]
        await asyncio.gather(*gateways)
        last.set_result(max(one.seq for one in posted))
        await asyncio.wait_for(watching, LAST_WITHIN_S)
    counted = [one for one in posted if one.sent >= began + WARM_S]
    return counted, shown


async def _watch(screen: ClientConnection, shown: list[tuple[float, int]], last: asyncio.Future[int]) -> None:
    """Note what comes, until the last batch is in it; a heartbeat comes every second in any case."""
    async for message in screen:
        at = time.perf_counter()
        seen = _decode(message)
        if seen.type in {"frame", "delta"}:
            shown.append((at, seen.seq))
        if last.done() and shown and shown[-1][1] >= last.result():
            return


async def _gateway(
    client: Client, path: str, number: int, crews: Crews, began: float, posted: list[Posted]
) -> None:
    """Post every fifth of a second, gateways one after the other, each batch when it is due."""
    period = 1.0 / RATE_HZ
    for batch in range(1, int((WARM_S + COUNTED_S) * RATE_HZ) + 1):
        await asyncio.sleep(began + (batch + number / GATEWAYS) * period - time.perf_counter())
        content = body(number, batch, crews.report(number, time.time()))
        sent = time.perf_counter()
        receipt = await client.post(path, content)
        posted.append(Posted(sent, time.perf_counter(), receipt["seq"]))
    client.close()


async def _bare(size: int) -> list[float]:
    """What passing as many bytes on costs where nothing is done with them (ms)."""
    loop = asyncio.get_running_loop()
    received = asyncio.Event()

    class Screen(asyncio.Protocol):
        def __init__(self) -> None:
            self.left = size

        def data_received(self, data: bytes) -> None:
            self.left -= len(data)
            if self.left == 0:
                self.left = size
                received.set()

    class Relay(asyncio.Protocol):
        def connection_made(self, transport: asyncio.BaseTransport) -> None:
            relays.append(cast("asyncio.Transport", transport))

        def data_received(self, data: bytes) -> None:
            relays[1].write(data)

    relays: list[asyncio.Transport] = []
    server = await loop.create_server(Relay, "127.0.0.1", 0)
    port = server.sockets[0].getsockname()[1]
    gateway, _ = await loop.create_connection(asyncio.Protocol, "127.0.0.1", port)
    await asyncio.sleep(0.05)
    await loop.create_connection(Screen, "127.0.0.1", port)
    await asyncio.sleep(0.05)
    values = []
    for _ in range(BARE_ROUNDS):
        sent = time.perf_counter()
        received.clear()
        gateway.write(bytes(size))
        await received.wait()
        values.append(1000.0 * (time.perf_counter() - sent))
    server.close()
    return values
