"""The messages between web process and worker, and what the routes see of whatever carries them."""

from collections.abc import Awaitable, Callable
from typing import Protocol

import msgspec


class Wake(msgspec.Struct, frozen=True, tag="wake"):
    """The log of an incident has grown.

    Attributes:
        incident: which one.
        seq: its newest entry.
    """

    incident: str
    seq: int


class Query(msgspec.Struct, frozen=True, tag="query"):
    """A question to the worker that holds an incident.

    Attributes:
        number: which answer belongs to it.
        incident: which incident.
        a: a node.
        b: another node.
    """

    number: int
    incident: str
    a: str
    b: str


class Answer(msgspec.Struct, frozen=True, tag="answer"):
    """The answer to a query.

    Attributes:
        number: of the query.
        found: the nodes are known and have a decided position.
        detail: why not, where it is not so.
        delta_m: position of `b` less that of `a` (m).
        covariance_m2: of it, upper triangle (m²).
        followed: the worker follows the incident; otherwise it cannot tell.
        unknown: one of the nodes is not known; otherwise, not found, its position is not decided.
    """

    number: int
    found: bool
    detail: str = ""
    delta_m: tuple[float, float, float] | None = None
    covariance_m2: tuple[float, float, float, float, float, float] | None = None
    followed: bool = True
    unknown: bool = False


class Picture(msgspec.Struct, frozen=True, tag="picture"):
    """The newest picture of an incident.

    Attributes:
        incident: which one.
        seq: the newest log entry in it.
        record: the picture, encoded by `backend.live.record`.
        row: newest second whose row is final, stored or about to be; None: all of them are stored.
        failed: the estimator could not go on; the picture stands still.
        since_t: since when it has been shown: what was shown before stands in rows, Unix seconds; None: it is
            not known.
    """

    incident: str
    seq: int
    record: bytes
    row: int | None = None
    failed: bool = False
    since_t: float | None = None


class Alive(msgspec.Struct, frozen=True, tag="alive"):
    """The worker goes on, though it may have nothing to tell."""


ToWorker = Wake | Query
ToWeb = Answer | Picture | Alive


class WebSide(Protocol):
    """What the web process sees of the link."""

    def wake(self, incident: str, seq: int) -> None:
        """Tell the workers that the log has grown; harmless if none is there."""

    async def ask(self, incident: str, a: str, b: str, timeout_s: float) -> Answer:
        """Ask the worker that follows an incident where `b` is relative to `a`.

        Raises:
            Unavailable: no worker is connected that follows it, or it went away.
            TooSlow: it did not answer in time.
        """

    def on_picture(self, listener: Callable[[Picture], Awaitable[None] | None]) -> None:
        """Have every picture that comes given to `listener`."""
