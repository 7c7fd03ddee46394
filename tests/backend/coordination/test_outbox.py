"""What waits to be sent is bounded, and the newest of a kind wins."""

import asyncio

from backend.coordination.outbox import Outbox


def sent(outbox: Outbox) -> list[bytes]:
    """What a peer gets that reads everything at once."""

    async def go() -> list[bytes]:
        received: list[bytes] = []

        async def take(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            while chunk := await reader.read(65_536):
                received.append(chunk)
            writer.close()

        async with await asyncio.start_server(take, "127.0.0.1", 0) as server:
            _, writer = await asyncio.open_connection(*server.sockets[0].getsockname()[:2])
            sending = asyncio.create_task(outbox.send_to(writer))
            await asyncio.sleep(0.05)
            sending.cancel()
            writer.close()
            await writer.wait_closed()
            await asyncio.sleep(0.05)
        return [bytes([byte]) for byte in b"".join(received)]

    return asyncio.run(go())


def test_a_message_that_waits_is_superseded_by_the_next_of_its_key() -> None:
    outbox = Outbox()
    for key, message in (("i1", b"1"), ("i2", b"2"), ("i1", b"3")):
        outbox.put(key, message)
    assert sent(outbox) == [b"3", b"2"]


def test_where_too_much_waits_the_oldest_is_dropped() -> None:
    outbox = Outbox(max_waiting=3)
    for number in range(10):
        outbox.put(number, b"%d" % number)
    assert sent(outbox) == [b"7", b"8", b"9"]


def test_what_was_cleared_is_not_sent() -> None:
    outbox = Outbox()
    outbox.put("i1", b"1")
    outbox.clear()
    assert sent(outbox) == []
