"""Just enough of an HTTP client that its own time does not count in a benchmark."""

import asyncio
from typing import Any, Self

import msgspec


class Client:
    """One keep-alive connection.

    Args:
        reader: of the connection.
        writer: of the connection.
        host: for the `Host` header.
    """

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, host: str) -> None:
        self._reader, self._writer, self._host = reader, writer, host

    @classmethod
    async def to(cls, host: str, port: int) -> Self:
        """Connect."""
        reader, writer = await asyncio.open_connection(host, port)
        return cls(reader, writer, f"{host}:{port}")

    async def post(self, path: str, body: bytes) -> Any:
        """POST JSON; the decoded answer.

        Raises:
            RuntimeError: the answer is no success.
        """
        head = (
            f"POST {path} HTTP/1.1\r\nHost: {self._host}\r\nContent-Type: application/json\r\n"
            f"Content-Length: {len(body)}\r\n\r\n"
        )
        self._writer.write(head.encode() + body)
        head_of_answer = await self._reader.readuntil(b"\r\n\r\n")
        lines = head_of_answer.decode("latin-1").split("\r\n")
        headers = dict(line.lower().split(": ", 1) for line in lines[1:] if line)
        answer = await self._reader.readexactly(int(headers["content-length"]))
        if lines[0].split(" ")[1][0] != "2":
            raise RuntimeError(f"POST {path}: {lines[0]} {answer[:500]!r}")
        return msgspec.json.decode(answer)

    def close(self) -> None:
        """Disconnect."""
        self._writer.close()
