"""Every refusal that Firethread gives: those of requests as one tree with its form on the wire (RFC 9457).

Problem              500    anything that is answered as `application/problem+json`; itself a defect of ours
├── NotUnderstood    400    the body is no JSON, or not what the route takes
├── NotAuthenticated 401    no valid access token
├── NotFound         404    no such incident, node or page
├── NotAllowed       405    the page does not take this method
├── Conflict         409    the incident is closed, or what is asked contradicts what is there
├── TooLarge         413    more readings or bytes than a batch may have
├── WrongMediaType   415    content type or encoding that is not taken
├── Invalid          422    a field or parameter outside its bounds
├── NeedsSocket      426    a socket is asked for as a page
├── TooBusy          429    the log cannot keep up; come back after `retry_after_s`
├── Unavailable      503    the log cannot be written, or the estimator is away
└── TooSlow          504    what was waited for did not come in time

CommandRefused              what a command was given cannot work; there are kinds of it where they are raised
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from http import HTTPStatus
from typing import Any, ClassVar, Self

import msgspec

PROBLEM_MEDIA_TYPE = "application/problem+json"


class FieldError(msgspec.Struct, frozen=True, omit_defaults=True):
    """One of several things that are wrong.

    Attributes:
        code: what it is, for programs.
        message: what it is and what to do, for people.
        index: of the reading, where it is one of a batch.
        field: path of the field.
    """

    code: str
    message: str
    index: int | None = None
    field: str | None = None


class Problem(Exception):  # noqa: N818 - RFC 9457 calls it a problem
    """A refusal with its status.

    Args:
        detail: what was wrong, where, and what to do.
        errors: the single faults, where there are several.
        retry_after_s: after how long trying again makes sense.
    """

    status: ClassVar[int] = 500
    slug: ClassVar[str] = "unexpected"
    title: ClassVar[str] = "Something went wrong here"

    def __init__(
        self, detail: str, errors: Sequence[FieldError] = (), *, retry_after_s: int | None = None
    ) -> None:
        super().__init__(detail)
        self.detail = detail
        self.errors = tuple(errors)
        self.retry_after_s = retry_after_s

    def body(self) -> bytes:
        """The problem as JSON bytes."""
        problem: dict[str, object] = {
            "type": f"urn:firethread:problem:{self.slug}",
            "title": self.title,
            "status": self.status,
            "detail": self.detail,
        }
        if self.errors:
            problem["errors"] = self.errors
        return msgspec.json.encode(problem)

    def headers(self) -> dict[str, str]:
        """The headers that go with it."""
        headers = {"content-type": PROBLEM_MEDIA_TYPE}
        if self.retry_after_s is not None:
            headers["retry-after"] = str(self.retry_after_s)
        return headers

    def last_response(self) -> bytes:
        """The whole HTTP/1.1 response, after which the connection closes: for a protocol, below ASGI."""
        body = self.body()
        headers = self.headers() | {"content-length": str(len(body)), "connection": "close"}
        status = f"HTTP/1.1 {self.status} {HTTPStatus(self.status).phrase}"
        head = [status, *(f"{name}: {value}" for name, value in headers.items()), "", ""]
        return "\r\n".join(head).encode() + body


class NotUnderstood(Problem):
    """The body is no JSON, or not what the route takes."""

    status, slug, title = 400, "not-understood", "The request could not be understood"


class NotAuthenticated(Problem):
    """No valid access token came with the request."""

    status, slug, title = 401, "not-authenticated", "An access token is needed"

    def headers(self) -> dict[str, str]:
        """The headers that go with it."""
        return super().headers() | {"www-authenticate": 'Bearer realm="firethread"'}


class NotFound(Problem):
    """There is nothing under that name."""

    status, slug, title = 404, "not-found", "There is nothing under that name"


class NotAllowed(Problem):
    """The page does not take this method."""

    status, slug, title = 405, "method-not-allowed", "The page does not take this method"


class Conflict(Problem):
    """What is asked contradicts what is there."""

    status, slug, title = 409, "conflict", "The request contradicts what is there"


class TooLarge(Problem):
    """More than the limits allow."""

    status, slug, title = 413, "too-large", "The request is too large"


class WrongMediaType(Problem):
    """A content type or encoding that is not taken."""

    status, slug, title = 415, "wrong-media-type", "The content type or encoding is not taken here"


class Invalid(Problem):
    """A field or parameter is missing or outside its bounds."""

    status, slug, title = 422, "invalid", "A field or parameter is not valid"

    @classmethod
    def by_field(cls, faults: Sequence[Mapping[str, Any]], within: Sequence[str] = ()) -> Self:
        """Each field with what is wrong with it.

        Args:
            faults: as pydantic finds them.
            within: path of what was looked at, where it is itself a field.
        """
        errors = [
            FieldError(
                code=str(fault["type"]),
                field=".".join((*within, *map(str, fault["loc"]))),
                message=str(fault["msg"]).removeprefix("Value error, "),  # pydantic's own, before ours
            )
            for fault in faults
        ]
        return cls("; ".join(f"{error.field}: {error.message}" for error in errors), errors)


class NeedsSocket(Problem):
    """A socket is asked for as a page."""

    status, slug, title = 426, "needs-websocket", "This is a WebSocket, not a page"

    def headers(self) -> dict[str, str]:
        """The headers that go with it."""
        return super().headers() | {"upgrade": "websocket"}


class TooBusy(Problem):
    """The log cannot keep up."""

    status, slug, title = 429, "too-busy", "The log cannot keep up"


class Unavailable(Problem):
    """A part that the answer needs is away."""

    status, slug, title = 503, "unavailable", "A part that is needed is not available"


class TooSlow(Problem):
    """What was waited for did not come in time."""

    status, slug, title = 504, "too-slow", "What was waited for did not come in time"


class CommandRefused(Exception):  # noqa: N818 - names the condition
    """What a command was given cannot work; the message is one line that says what to mend."""


@contextmanager
def in_reach(what: object) -> Iterator[None]:
    """Refuse a file or folder that a command was given where the operating system does.

    Args:
        what: its name.

    Raises:
        CommandRefused: it cannot be read or written.
        BrokenPipeError: whoever read what is written has ended.
    """
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        raise CommandRefused(f"{what} cannot be used: {error.strerror or error}") from error
