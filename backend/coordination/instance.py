"""Which process a lease is held by: of two under one name, the one that lives keeps what it holds."""

import os
import secrets
import socket
from typing import Self

import msgspec

_TOKEN = secrets.token_hex(4)


class Instance(msgspec.Struct, frozen=True):
    """A process.

    Attributes:
        host: name of its machine or container.
        pid: its number there.
        token: of its own: after a restart a container gives the same numbers again.
    """

    host: str
    pid: int
    token: str

    @classmethod
    def this(cls) -> Self:
        """This process."""
        return cls(socket.gethostname(), os.getpid(), _TOKEN)

    def ended(self, seen_by: "Instance") -> bool:
        """Whether it is sure that this process has ended; of other machines' nothing is.

        Args:
            seen_by: the process that asks.
        """
        if self.host != seen_by.host:
            return False
        if self.pid == seen_by.pid:
            return self.token != seen_by.token
        try:
            os.kill(self.pid, 0)  # asks only
        except ProcessLookupError:
            return True
        except PermissionError:
            return False
        return False


def holder_text(name: str, instance: Instance) -> str:
    """What stands in the lease of a holder."""
    return f"{name} {instance.host} {instance.pid} {instance.token}"


def parse_holder(text: str) -> tuple[str, Instance | None]:
    """The inverse of `holder_text`; older versions wrote the name alone."""
    parts = text.rsplit(" ", 3)
    if len(parts) < 4 or not parts[2].isdigit():
        return text, None
    name, host, pid, token = parts
    return name, Instance(host, int(pid), token)
