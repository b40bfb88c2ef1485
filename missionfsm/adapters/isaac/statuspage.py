"""What a mission server does, over HTTP, for whoever looks: read only, on loopback, in threads of its own."""

from __future__ import annotations

import asyncio
import concurrent.futures
import http.server
import threading
from collections.abc import Callable, Mapping
from http import HTTPStatus
from typing import Final

from missionfsm.adapters.isaac.tcp import LOOPBACK

Answer = Callable[[], bytes]
"""Makes a body; is called on the event loop."""

_PATIENCE: Final = 5.0  # seconds for an event loop that is busy, and for a client that says nothing
_HEADERS: Final = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "connect-src 'self'; img-src data:; frame-ancestors 'none'",
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
