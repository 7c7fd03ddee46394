"""Parameters that a route does not know: who misspells one would get an answer to another question."""

from fastapi.exceptions import RequestValidationError, WebSocketRequestValidationError
from starlette.requests import HTTPConnection

from backend.authentication import SOCKET_TOKEN


async def known_parameters(asked: HTTPConnection) -> None:
    """Refuse a request or a socket whose query names what its route does not take: a dependency of routes.

    Raises:
        RequestValidationError: a request does.
        WebSocketRequestValidationError: a socket does.
    """
    if not asked.query_params:
        return
    known = {field.alias for field in asked.scope["route"].dependant.query_params}
    socket = asked.scope["type"] == "websocket"
    if socket:
        known.add(SOCKET_TOKEN)
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
    if faults:
        raise (WebSocketRequestValidationError if socket else RequestValidationError)(faults)
