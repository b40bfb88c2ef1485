"""Whether a stream has begun or was refused, as a client can tell."""

from __future__ import annotations

import contextlib
import threading
from typing import Any

import grpc

REFUSAL_SECONDS = 0.1
"""How long a refusal is awaited once empty initial metadata have come."""


class Begun:
    """Waits until a stream begins or is refused."""

    def __init__(self, call: Any) -> None:  # noqa: ANN401 - a call of grpc
        self._call = call
        self.refusal: grpc.RpcError | None = None

    def wait(self, seconds: float) -> None:
        """Wait so long at most; a server may say that a stream has begun only with its first message."""
        thread = threading.Thread(target=self._look, name="missionfsm-begun", daemon=True)
        thread.start()
        thread.join(seconds)

    def _look(self) -> None:
        ended = threading.Event()
        if self._call.add_callback(ended.set):  # it has not ended yet
            with contextlib.suppress(grpc.RpcError):
                if not self._call.initial_metadata():  # a refusal has none, which looks as if they were empty
                    ended.wait(REFUSAL_SECONDS)
        if self._call.done() and self._call.code() is not grpc.StatusCode.OK:
            self.refusal = self._call
