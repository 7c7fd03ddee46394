"""How FastAPI answers what goes wrong: always in the contract's form."""

from collections.abc import Sequence

import structlog
from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError, WebSocketRequestValidationError
from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.routing import Match, Mount, compile_path
from starlette.websockets import WebSocket

from backend.errors import (
    PROBLEM_MEDIA_TYPE,
    Conflict,
    FieldError,
    Invalid,
    NeedsSocket,
    NotAllowed,
    NotAuthenticated,
    NotFound,
    NotUnderstood,
    Problem,
    TooBusy,
    TooLarge,
    TooSlow,
    Unavailable,
    WrongMediaType,
)

API = "/api/"
NO_SOCKET = "open it as a WebSocket, ws:// or wss://; a proxy on the way has to hand on its upgrade"
NO_JSON = "the body is no JSON; send one JSON object in UTF-8"

log = structlog.get_logger()

BY_STATUS: dict[int, type[Problem]] = {
    kind.status: kind
    for kind in (
        NotUnderstood,
        NotAuthenticated,
        NotFound,
        NotAllowed,
        Conflict,
        TooLarge,
        WrongMediaType,
        Invalid,
        TooBusy,
        Problem,
        Unavailable,
        TooSlow,
    )
}


def install(app: FastAPI) -> None:
    """Have every refusal and every defect answered as `application/problem+json`."""

    @app.exception_handler(Problem)
    async def refused(_: Request, problem: Problem) -> Response:
        return answer(problem)

    @app.exception_handler(RequestValidationError)
    async def not_valid(_: Request, error: RequestValidationError) -> Response:
        return answer(from_validation(error.errors()))

    @app.exception_handler(WebSocketRequestValidationError)
    async def not_opened(socket: WebSocket, error: WebSocketRequestValidationError) -> None:
        await deny(socket, from_validation(error.errors()))

    @app.exception_handler(HTTPException)
    async def by_status(request: Request, error: HTTPException) -> Response:
        if is_socket(request):
            return answer(NeedsSocket(f"{request.url.path}: {NO_SOCKET}"))
        kind = BY_STATUS.get(error.status_code, Problem)
        methods = methods_of(request)
        # The screen's files lie under every path: what no route of the API takes ends there, as not found, or
        # by another method as not allowed.
        if kind is NotFound and methods and request.method not in methods:
            kind = NotAllowed
        if kind is NotAllowed and not methods:
            if request.url.path.startswith(API):
                kind = NotFound
            methods = {"GET", "HEAD"}
        detail = f"{request.method} {request.url.path}: {kind.title.lower()}"
        if kind is NotAllowed:
            detail += f"; it takes {', '.join(sorted(methods))}"
        if kind is NotFound:
            detail += "; /docs lists what there is"
        response = answer(kind(NO_JSON if kind is NotUnderstood else detail))
        if kind.status == error.status_code:
            response.headers.update(error.headers or {})
        if kind is NotAllowed:
            response.headers["allow"] = ", ".join(sorted(methods))
        return response

    @app.exception_handler(Exception)
    async def defect(request: Request, error: Exception) -> Response:
        log.error("request failed", method=request.method, path=request.url.path, exc_info=error)
        return answer(Problem("this is a defect of the server, not of the request; its log tells more"))


def methods_of(request: Request) -> set[str]:
    """The methods that a path of the API takes, by the OpenAPI document; none where there is no such path."""
    return {
        method.upper()
        for path, operations in request.app.openapi()["paths"].items()
        if compile_path(path)[0].match(request.url.path)
        for method in operations
    }


def is_socket(request: Request) -> bool:
    """Whether a path is that of a socket. The screen, which is mounted, answers under every path."""
    scope = {**request.scope, "type": "websocket"}
    routes = (route for route in request.app.routes if not isinstance(route, Mount))
    return any(route.matches(scope)[0] is Match.FULL for route in routes)


def answer(problem: Problem) -> Response:
    """The HTTP response that a problem is."""
    return Response(problem.body(), problem.status, problem.headers())


async def deny(socket: WebSocket, problem: Problem) -> None:
    """Refuse a socket before it is open, in the form in which any request is refused.

    Programs read the answer to the handshake; to a page a browser tells only that the socket did not open.
    """
    await socket.send_denial_response(answer(problem))


def from_validation(faults: Sequence[dict[str, object]]) -> Problem:
    """The problem that findings are: 400 for no JSON, 415 where it is not announced, else 422 by field."""
    for fault in faults:
        if fault["type"] == "json_invalid":
            return NotUnderstood(NO_JSON)
        if fault["loc"] == ("body",) and isinstance(fault.get("input"), bytes):  # not read as JSON
            return WrongMediaType(
                "The body is not announced as JSON: send it with the content type application/json."
            )
    return Invalid.by_field(faults)


def reversed_span() -> Invalid:
    """The refusal of a span of time that ends before it begins."""
    message = "`to` is before `from`: exchange them"
    return Invalid(message, [FieldError(code="reversed", field="query.to", message=message)])


def openapi_responses(*statuses: int) -> dict[int | str, dict[str, object]]:
    """The refusals of a route, for the OpenAPI document.

    Args:
        statuses: of `BY_STATUS`.
    """
    problem = {PROBLEM_MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}}
    return {status: {"description": BY_STATUS[status].title, "content": problem} for status in statuses}
