"""The telemetry route without a server: requests as ASGI messages, and what is sent back."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from starlette.types import Message, Scope


@dataclass(frozen=True)
class Answer:
    """A response."""

    status: int
    headers: dict[str, str]
    body: bytes

    def json(self) -> Any:
        return json.loads(self.body)


def scope(path: str, headers: dict[str, str], method: str = "POST") -> Scope:
    return {
        "type": "http",
        "asgi": {"version": "3.0"},
        "http_version": "1.1",
        "method": method,
        "path": path,
        "raw_path": path.encode(),
        "root_path": "",
        "query_string": b"",
        "scheme": "http",
        "headers": [(name.lower().encode(), value.encode()) for name, value in headers.items()],
    }


class Body:
    """A request's body, given in parts; afterwards, or where a part is None, the client has gone."""

    def __init__(self, parts: Sequence[bytes | None]) -> None:
        self.parts = list(parts)
        self.given = 0

    async def __call__(self) -> Message:
        if self.given == len(self.parts) or self.parts[self.given] is None:
            return {"type": "http.disconnect"}
        part = self.parts[self.given]
        self.given += 1
        return {"type": "http.request", "body": part, "more_body": self.given < len(self.parts)}


class Sent:
    """What an application sends."""

    def __init__(self) -> None:
        self.messages: list[Message] = []

    async def __call__(self, message: Message) -> None:
        self.messages.append(message)

    @property
    def answer(self) -> Answer:
        start, *rest = self.messages
        return Answer(
            start["status"],
            {name.decode(): value.decode() for name, value in start["headers"]},
            b"".join(message.get("body", b"") for message in rest),
        )
