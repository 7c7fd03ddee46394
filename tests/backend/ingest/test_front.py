import asyncio
import json

from starlette.types import Receive, Scope, Send

from backend.ingest.front import TelemetryFirst
from tests.backend.ingest.asgi import Body, Sent, scope
from tests.backend.ingest.gateway import Field


def test_telemetry_goes_to_its_route_and_all_else_to_the_application(gateway: Field) -> None:
    passed: list[str] = []

    async def app(scope: Scope, receive: Receive, send: Send) -> None:
        del receive, send
        passed.append(scope["type"] if "path" not in scope else scope["path"])

    front = TelemetryFirst(app, gateway.route, gateway.route.handle)
    incident = gateway.incident()
    path, sent = f"/api/v1/incidents/{incident}/telemetry", Sent()
    body = json.dumps({"gateway": "g", "batch": "b", "readings": []}).encode()
    asyncio.run(front(scope(path, {"content-type": "application/json"}), Body([body]), sent))
    assert sent.answer.status == 202
    assert passed == []
    asyncio.run(front(scope(f"/api/v1/incidents/{incident}", {}), Body([]), Sent()))
    asyncio.run(front({"type": "lifespan"}, Body([]), Sent()))
    assert passed == [f"/api/v1/incidents/{incident}", "lifespan"]


def test_who_asks_is_checked_first(gateway: Field) -> None:
    async def guard(scope: Scope, receive: Receive, send: Send) -> None:
        del scope, receive
        await send({"type": "http.response.start", "status": 401, "headers": []})

    front = TelemetryFirst(gateway.route, gateway.route, guard)
    sent = Sent()
    asyncio.run(front(scope(f"/api/v1/incidents/{gateway.incident()}/telemetry", {}), Body([b"{}"]), sent))
    assert sent.answer.status == 401
