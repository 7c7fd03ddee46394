"""Reading a request's body within its limits."""

import zlib

from starlette.types import Receive, Scope

from backend.errors import NotUnderstood, TooLarge, WrongMediaType

_GZIP = 31
"""zlib's `wbits` for a gzip header and trailer with the largest window."""

MAX_MEMBERS = 10_000
"""One for each reading of a batch. Empty ones take no room and would hold the event loop for seconds."""


class ClientGone(Exception):  # noqa: N818 - names the condition
    """The client hung up before its body was whole."""


async def read_body(scope: Scope, receive: Receive, limit: int) -> bytes:
    """The JSON body of a request, decompressed.

    Args:
        scope: of the request.
        receive: gives the parts of its body.
        limit: bytes that it may have, before and after decompression.

    Raises:
        WrongMediaType: it is not JSON, or encoded otherwise than with gzip.
        TooLarge: it is over the limit; found out before it is read or decompressed further.
        NotUnderstood: the gzip is broken, cut short, followed by something else, or in too many members.
        ClientGone: the client hung up.
    """
    compressed = _check_headers(scope, limit)
    message = await receive()
    if not compressed and message["type"] == "http.request" and not message.get("more_body", False):
        whole: bytes = message.get("body", b"")
        if len(whole) > limit:
            raise _too_large(limit)
        return whole
    parts: list[bytes] = []
    size = 0
    gunzip = Gunzip(limit) if compressed else None
    while True:
        if message["type"] == "http.disconnect":
            raise ClientGone
        part = message.get("body", b"")
        size += len(part)
        if size > limit:
            raise _too_large(limit)
        parts.append(part if gunzip is None else gunzip.feed(part))
        if not message.get("more_body", False):
            break
        message = await receive()
    if gunzip is not None:
        gunzip.finish()
    return b"".join(parts)


class Gunzip:
    """Decompresses gzip, of one member or of several (RFC 1952, 2.2), never beyond a limit.

    Args:
        limit: bytes that may come out of it.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._left = limit
        self._members = 1
        self._stream = zlib.decompressobj(_GZIP)

    def feed(self, part: bytes) -> bytes:
        """Decompress the next part.

        Raises:
            TooLarge: more comes out than the limit allows.
            NotUnderstood: it is no gzip, or something else follows it, or it has too many members.
        """
        out = []
        while part:
            if self._stream.eof:
                self._begin_member()
            out.append(self._decompressed(part))
            part = self._stream.unused_data
        return b"".join(out)

    def finish(self) -> None:
        """Check that the last member is whole.

        Raises:
            NotUnderstood: it has been cut short.
        """
        if not self._stream.eof:
            raise NotUnderstood("The gzip stream of the body is cut short: send the batch again.")

    def _begin_member(self) -> None:
        self._members += 1
        if self._members > MAX_MEMBERS:
            raise NotUnderstood(f"The body has more than {MAX_MEMBERS} gzip members: send it as one.")
        self._stream = zlib.decompressobj(_GZIP)

    def _decompressed(self, part: bytes) -> bytes:
        try:
            out = self._stream.decompress(part, self._left + 1)
        except zlib.error as error:
            where = (
                "announced as gzip and is not"
                if self._members == 1
                else f"no gzip after its member {self._members - 1}"
            )
            raise NotUnderstood(f"The body is {where}: {error}.") from error
        if len(out) > self._left:
            raise _too_large(self._limit)
        self._left -= len(out)
        return out


def _check_headers(scope: Scope, limit: int) -> bool:
    """Refuse what need not be read; True if the body is compressed."""
    media = encoding = b""
    for name, value in scope["headers"]:
        if name == b"content-type":
            media = value
        elif name == b"content-encoding":
            encoding = value.strip().lower()
        elif name == b"content-length" and value.isdigit() and int(value) > limit:
            raise _too_large(limit)
    if media != b"application/json" and media.split(b";")[0].strip().lower() != b"application/json":
        shown = media.decode("latin-1")[:100] or "none"
        raise WrongMediaType(f"The content type is {shown}: send application/json.")
    if encoding in {b"", b"identity"}:
        return False
    if encoding in {b"gzip", b"x-gzip"}:
        return True
    shown = encoding.decode("latin-1")[:100]
    raise WrongMediaType(f"The content encoding is {shown}: send gzip, or the body as it is.")


def _too_large(limit: int) -> TooLarge:
    return TooLarge(f"The body is larger than {limit} bytes (uncompressed). Send the readings in parts.")
