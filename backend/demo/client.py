"""The public API as a gateway uses it over an unreliable link: the same batch until it is acknowledged."""

import asyncio
import ipaddress
import random
import re
from contextlib import suppress
from typing import Any

import httpx2
import structlog

from backend.errors import CommandRefused

log = structlog.get_logger(__name__)

FIRST_PAUSE_S = 0.2
LONGEST_PAUSE_S = 5.0
TIMEOUT_S = 10.0
BUSY = frozenset({429, 502, 503, 504})
GONE = frozenset({404, 409})
HOST_NAME = re.compile(r"(?=.{1,253}$)[A-Za-z0-9_-]{1,63}(\.[A-Za-z0-9_-]{1,63})*\.?")


class IncidentGone(Exception):  # noqa: N818 - names the condition
    """The incident was closed, or its database is a new one."""


class Refused(CommandRefused):
    """The server refuses what we send, and would refuse it again."""


class Client:
    """Requests that are repeated until they are answered.

    Args:
        url: of the server, such as `http://127.0.0.1:8000`.
        token: its access token; None where it is open.

    Raises:
        CommandRefused: `url` is no address of a server.
    """

    def __init__(self, url: str, token: str | None) -> None:
        # What is no address would never be answered, and be tried again for ever.
        if not url.startswith(("http://", "https://")) or not _names_a_server(url):
            raise CommandRefused(f"--url takes an address such as http://127.0.0.1:8000, not {url!r}")
        headers = {} if token is None else {"authorization": f"Bearer {token}"}
        # A proxy of the environment has no business between a gateway and its server.
        self._http = httpx2.AsyncClient(
            base_url=url, headers=headers, timeout=httpx2.Timeout(TIMEOUT_S), trust_env=False
        )

    async def close(self) -> None:
        """Give the connections back."""
        await self._http.aclose()

    async def wait_until_ready(self) -> None:
        """Return when the server says that it is ready."""
        await self.ask("GET", "/readyz")

    async def active_incidents(self) -> list[dict[str, Any]]:
        """The incidents that are not closed."""
        answer = await self.ask("GET", "/api/v1/incidents?state=active")
        return list(answer.json())

    async def create_incident(self, incident: dict[str, Any]) -> str:
        """Begin an incident; its id."""
        answer = await self.ask("POST", "/api/v1/incidents", json=incident)
        return str(answer.json()["id"])

    async def close_incident(self, incident: str) -> None:
        """Close an incident; one that is gone or closed already is no error."""
        try:
            await self.ask("PATCH", f"/api/v1/incidents/{incident}", gone=GONE, json={"state": "closed"})
        except IncidentGone:
            return

    async def post(self, incident: str, body: bytes) -> dict[str, Any]:
        """Post a batch; the acknowledgement. The body keeps its key over all tries, so it counts once.

        Raises:
            IncidentGone: the incident takes no more telemetry.
            Refused: the batch is not what the server takes.
        """
        answer = await self.ask(
            "POST",
            f"/api/v1/incidents/{incident}/telemetry",
            gone=GONE,
            content=body,
            headers={"content-type": "application/json"},
        )
        acknowledged: dict[str, Any] = answer.json()
        if acknowledged["rejected"]:
            log.warning("readings were set aside", rejected=acknowledged["rejected"][:3])
        return acknowledged

    async def ask(
        self, method: str, path: str, gone: frozenset[int] = frozenset(), **request: Any
    ) -> httpx2.Response:
        """Send a request, again after a growing pause while the server is away or busy.

        A `Retry-After` of the server is waited for. There is no last try: a gateway has nothing better to do.

        Args:
            method: of HTTP.
            path: under the server's URL.
            gone: which statuses say that the incident takes nothing more.
            request: as `httpx2.AsyncClient.request` takes it.

        Raises:
            IncidentGone: one of `gone` was answered.
            Refused: any other status of 400 or above.
        """
        pause_s = FIRST_PAUSE_S
        while True:
            try:
                answer = await self._http.request(method, path, **request)
            except httpx2.TransportError as error:
                log.warning("no answer, trying again", path=path, why=type(error).__name__, pause_s=pause_s)
                wait_s = pause_s
            else:
                if answer.status_code < 400:
                    return answer
                if answer.status_code in gone:
                    raise IncidentGone(f"{method} {path}: {answer.status_code}")
                if answer.status_code not in BUSY:
                    raise Refused(f"{method} {path} gave {answer.status_code}: {answer.text[:500]}")
                wait_s = _retry_after_s(answer, pause_s)
                log.warning("busy, trying again", path=path, status=answer.status_code, pause_s=wait_s)
            # Gateways that lost the same server must not all come back in the same instant.
            await asyncio.sleep(wait_s * random.uniform(1.0, 1.2))  # noqa: S311 - spreads load, guards nothing
            pause_s = min(2 * pause_s, LONGEST_PAUSE_S)


def _names_a_server(url: str) -> bool:
    """Whether a URL names a host and a port that there can be."""
    try:
        parsed = httpx2.URL(url)
    except httpx2.InvalidURL:
        return False
    if parsed.port is not None and not 0 < parsed.port < 65536:
        return False
    host = parsed.raw_host.decode("ascii")  # names of other alphabets as they are looked up
    if HOST_NAME.fullmatch(host):
        return True
    with suppress(ValueError):
        return bool(ipaddress.ip_address(host.partition("%")[0]))
    return False


def _retry_after_s(answer: httpx2.Response, otherwise_s: float) -> float:
    """The pause that the server asks for (whole seconds, RFC 9110 10.2.3); dates are not worth a parser."""
    asked = answer.headers.get("retry-after", "")
    return max(float(asked), otherwise_s) if asked.isdigit() else otherwise_s
