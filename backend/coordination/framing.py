"""Messages on a stream: four bytes of length, then msgpack of a tagged struct."""

import asyncio
import struct

import msgspec

from backend.coordination.base import ToWeb, ToWorker
from backend.coordination.instance import Instance

MAX_MESSAGE_BYTES = 64 * 1024 * 1024
MAX_HELLO_BYTES = 4096
_length = struct.Struct("!I")
_encode = msgspec.msgpack.Encoder().encode


class Hello(msgspec.Struct, frozen=True, tag="hello"):
    """The first message of a worker.

    Attributes:
        token: the deployment's link token.
        holder: the worker's name.
        instance: its process; None: an older version does not say.
    """

    token: str
    holder: str
    instance: Instance | None = None


class Malformed(Exception):  # noqa: N818 - names the condition
    """What came is no message: the peer is of another version, or no peer."""


decode_hello = msgspec.msgpack.Decoder(Hello).decode
decode_to_web = msgspec.msgpack.Decoder(ToWeb).decode
decode_to_worker = msgspec.msgpack.Decoder(ToWorker).decode


def framed(message: Hello | ToWeb | ToWorker) -> bytes:
    """A message with its length in front."""
    body = _encode(message)
    return _length.pack(len(body)) + body


async def read_frame(reader: asyncio.StreamReader, limit: int = MAX_MESSAGE_BYTES) -> bytes:
    """The body of the next message.

    Raises:
        Malformed: it is longer than `limit`.
        asyncio.IncompleteReadError: the peer has closed.
    """
    (length,) = _length.unpack(await reader.readexactly(_length.size))
    if length > limit:
        raise Malformed(f"a message of {length} bytes, at most {limit} are taken")
    return await reader.readexactly(length)
