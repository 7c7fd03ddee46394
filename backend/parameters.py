"""Parameters that a route does not know, or takes once: who asked so would hear of something else."""

from typing import Any, get_args, get_origin

from fastapi.exceptions import RequestValidationError, WebSocketRequestValidationError
from starlette.requests import HTTPConnection

from backend.authentication import SOCKET_TOKEN


async def known_parameters(asked: HTTPConnection) -> None:
    """Refuse a request or a socket whose query names what its route does not take, or takes once: for routes.

    Raises:
        RequestValidationError: a request does.
        WebSocketRequestValidationError: a socket does.
    """
    if not asked.query_params:
        return
    several = {
        field.alias: _is_list(field.field_info.annotation)
        for field in asked.scope["route"].dependant.query_params
    }
    socket = asked.scope["type"] == "websocket"
    known = several.keys() | ({SOCKET_TOKEN} if socket else set())
    takes = ", ".join(f"`{name}`" for name in sorted(known)) or "none"
    faults = [
        {
            "type": "unknown_parameter",
            "loc": ("query", name),
            "msg": f"there is no such parameter here; it takes {takes}",
        }
        for name in asked.query_params
        if name not in known
    ]
    faults += [
        {
            "type": "repeated_parameter",
            "loc": ("query", name),
            "msg": "it is given more than once, and one is taken: ask for each by itself",
        }
        for name in asked.query_params
        if name in known and not several.get(name) and len(asked.query_params.getlist(name)) > 1
    ]
    if faults:
        raise (WebSocketRequestValidationError if socket else RequestValidationError)(faults)


def _is_list(kind: Any) -> bool:
    return any(get_origin(one) is list for one in (kind, *get_args(kind)))
