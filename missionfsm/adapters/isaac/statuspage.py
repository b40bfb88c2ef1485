"""What a mission server does, over HTTP, for whoever looks: read only, on loopback, in threads of its own."""

from __future__ import annotations

import asyncio
import concurrent.futures
import http.server
import importlib.resources
import json
import threading
from collections.abc import Callable, Mapping
from http import HTTPStatus
from typing import Any, Final

from missionfsm.adapters.isaac.settings import LOOPBACK

Answer = Callable[[], bytes]
"""Makes a body; is called on the event loop."""

_PATIENCE: Final = 5.0  # seconds for an event loop that is busy, and for a client that says nothing
_HEADERS: Final = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "connect-src 'self'; img-src data:; frame-ancestors 'none'",
}


def answers(standing: Callable[[], dict[str, Any]]) -> dict[str, tuple[str, Answer]]:
    """The page with the graph of missions, the same as JSON, and metrics for Prometheus.

    Args:
        standing: where everything stands: `missions` (mission, robot, status, upstream), `robots` (robot, peer) and
            `counts`, how many missions have which status.
    """
    template = importlib.resources.files("missionfsm").joinpath("pages", "templates", "dispatch.html").read_bytes()

    def metrics() -> bytes:
        now = standing()
        lines = ["# HELP missionfsm_missions Missions of the file, by status.", "# TYPE missionfsm_missions gauge"]
        lines += [f'missionfsm_missions{{status="{one}"}} {count}' for one, count in now["counts"].items()]
        lines += ["# HELP missionfsm_robots_connected Robots that are connected."]
        lines += ["# TYPE missionfsm_robots_connected gauge"]
        lines += [f"missionfsm_robots_connected {sum(one['peer'] is not None for one in now['robots'])}", ""]
        return "\n".join(lines).encode()

    return {
        "/": ("text/html; charset=utf-8", lambda: template),
        "/status.json": ("application/json", lambda: json.dumps(standing()).encode()),
        "/metrics": ("text/plain; version=0.0.4; charset=utf-8", metrics),
    }


class StatusPage:
    """Listens from the moment it is made, on the running event loop's behalf; OSError where the port is taken.

    Args:
        port: 0 is any free one; `port` then says which.
        answers: for each path the type of what is there, and what makes it.
    """

    def __init__(self, port: int, answers: Mapping[str, tuple[str, Answer]]) -> None:
        loop = asyncio.get_running_loop()

        class Handler(http.server.BaseHTTPRequestHandler):
            timeout = _PATIENCE

            def do_GET(self) -> None:
                kind, answer = answers.get(self.path.partition("?")[0], (None, None))
                if kind is None or answer is None:
                    self.send_error(HTTPStatus.NOT_FOUND)
                    return
                try:
                    body = asyncio.run_coroutine_threadsafe(_made(answer), loop).result(_PATIENCE)
                except (concurrent.futures.TimeoutError, concurrent.futures.CancelledError, RuntimeError):
                    self.send_error(HTTPStatus.SERVICE_UNAVAILABLE)
                    return
                self.send_response(HTTPStatus.OK)
                for name, value in {"Content-Type": kind, "Content-Length": str(len(body)), **_HEADERS}.items():
                    self.send_header(name, value)
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - its name in the library
                """Who looks is not worth a line."""

        class Server(http.server.ThreadingHTTPServer):
            daemon_threads = True

            def handle_error(self, request: object, client_address: object) -> None:
                """A client that goes away is no matter."""

        self._server = Server((LOOPBACK, port), Handler)
        self.port: int = self._server.server_address[1]
        self._thread = threading.Thread(
            target=lambda: self._server.serve_forever(0.05), name="missionfsm-http", daemon=True
        )
        self._thread.start()

    def close(self) -> None:
        """Stop listening."""
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()


async def _made(answer: Answer) -> bytes:
    return answer()
