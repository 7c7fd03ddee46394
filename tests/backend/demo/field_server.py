"""A small real HTTP server that takes telemetry as the contract says, over a link as bad as a test wants."""

import json
import socket
import struct
import threading
import time
from collections import deque
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

Fault = str
"""`503`, `429`: refused, nothing stored; `lost`: stored, but the link breaks before the acknowledgement."""


class FieldServer(ThreadingHTTPServer):
    """Incidents and their batches in memory; each telemetry request takes the next planned fault."""

    daemon_threads = True

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.faults: deque[Fault] = deque()
        self.not_ready = 0
        self.creating_lasts_s = 0.0
        self.incidents: dict[str, dict[str, Any]] = {}
        self.batches: dict[tuple[str, str, str], dict[str, Any]] = {}
        self.requests: list[tuple[str, str, bytes]] = []
        self.tokens: set[str | None] = set()
        self.lock = threading.Lock()
        self.thread = threading.Thread(target=self.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)
        self.thread.start()

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_address[1]}"

    def stop(self) -> None:
        self.shutdown()
        self.thread.join()
        self.server_close()

    def handle_error(self, request: object, client_address: object) -> None:
        """Broken links are what these tests are about: no traceback for each."""

    def entries(self, incident: str) -> int:
        return sum(of == incident for of, _, _ in self.batches)

    def posted(self, incident: str, gateway: str) -> list[dict[str, Any]]:
        return [b for (i, g, _), b in self.batches.items() if (i, g) == (incident, gateway)]


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True
    server: FieldServer

    def do_GET(self) -> None:
        with self.server.lock:
            if self.path == "/readyz":
                self.server.not_ready -= 1
                self._answer(503 if self.server.not_ready >= 0 else 200, {})
            else:
                self.server.tokens.add(self.headers["authorization"])
                active = [i for i in self.server.incidents.values() if i["state"] == "active"]
                self._answer(200, [i | {"last_seq": self.server.entries(i["id"])} for i in active])

    def do_PATCH(self) -> None:
        body = self._body()
        with self.server.lock:
            incident = self.server.incidents[self.path.rsplit("/", 1)[1]]
            incident.update(json.loads(body))
            self._answer(200, incident)

    def do_POST(self) -> None:
        body = self._body()
        with self.server.lock:
            if self.path == "/api/v1/incidents":
                name = f"i{len(self.server.incidents) + 1}"
                self.server.incidents[name] = json.loads(body) | {"id": name, "state": "active"}
                time.sleep(self.server.creating_lasts_s)
                self._answer(201, self.server.incidents[name])
            else:
                self._telemetry(self.path.split("/")[4], body)

    def _telemetry(self, incident: str, body: bytes) -> None:
        batch = json.loads(body)
        self.server.requests.append((batch["gateway"], batch["batch"], body))
        fault = self.server.faults.popleft() if self.server.faults else ""
        if fault in {"429", "503"}:
            self._answer(int(fault), {"title": "not now"}, {"retry-after": "1"})
            return
        if self.server.incidents[incident]["state"] == "closed":
            self._answer(409, {"title": "closed"})
            return
        key = (incident, batch["gateway"], batch["batch"])
        duplicate = key in self.server.batches
        self.server.batches.setdefault(key, batch)
        if fault == "lost":
            # A reset, as when a radio link dies: the gateway cannot know whether the batch came through.
            self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            self.connection.close()
            self.close_connection = True
            return
        self._answer(202, {"batch": batch["batch"], "seq": 1, "duplicate": duplicate, "rejected": []})

    def _body(self) -> bytes:
        return self.rfile.read(int(self.headers["content-length"]))

    def _answer(self, status: int, body: object, headers: dict[str, str] | None = None) -> None:
        content = json.dumps(body).encode()
        self.send_response(status)
        for name, value in {"content-length": str(len(content)), **(headers or {})}.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - the library's name
        """Quiet."""
