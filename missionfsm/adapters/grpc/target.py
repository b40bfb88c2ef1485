"""Where a gRPC server is, and how it is reached: what the tester and the proxy have in common."""

from __future__ import annotations

from pathlib import Path

import grpc
from attrs import field, frozen

KEEPALIVE_TIMEOUT_MS = 10_000
"""How long a connection may leave a question unanswered whether it is alive."""


@frozen
class Target:
    """A gRPC server.

    Attributes:
        address: ``host:port``.
        token: sent as ``authorization: Bearer TOKEN``; "" for none.
        metadata: sent with every call besides.
        certificate: a file in PEM with the authority that the server's certificate is checked against; "" for no TLS,
            ``system`` for the authorities of the machine.
        timeout: seconds that a call may take.
        settle: seconds of silence after which everything has settled. A control service with ``Settle`` says it itself.
        settle_most: seconds after which everything has settled even without silence.
        begin: seconds after which a stream that was not refused has begun, if the server does not say so. A server
            whose control service has ``Settle`` says it.
        keepalive: seconds of silence after which a connection is asked whether it is still alive; 0 for never, as is
            the default of gRPC: a server may end the connection for it with ENHANCE_YOUR_CALM, too_many_pings.
    """

    address: str
    token: str = field(default="", repr=False)
    metadata: tuple[tuple[str, str], ...] = ()
    certificate: str = ""
    timeout: float = 10.0
    settle: float = 0.2
    settle_most: float = 5.0
    begin: float = 1.0
    keepalive: float = 0.0

    @property
    def sent(self) -> tuple[tuple[str, str], ...]:
        """The metadata of every call."""
        return (*self.metadata, *((("authorization", f"Bearer {self.token}"),) if self.token else ()))

    def channel(self) -> grpc.Channel:
        """A connection. Raises OSError for a certificate that cannot be read."""
        options = (
            (
                ("grpc.keepalive_time_ms", round(1000 * self.keepalive)),
                ("grpc.keepalive_timeout_ms", KEEPALIVE_TIMEOUT_MS),
                ("grpc.http2.max_pings_without_data", 0),
            )
            if self.keepalive
            else ()
        )
        credentials = self.credentials()
        if credentials is None:
            return grpc.insecure_channel(self.address, options)
        return grpc.secure_channel(self.address, credentials, options)

    def credentials(self) -> grpc.ChannelCredentials | None:
        """What the server's certificate is checked with; None without TLS. Raises OSError, as `channel` does."""
        if not self.certificate:
            return None
        return grpc.ssl_channel_credentials(
            None if self.certificate == "system" else Path(self.certificate).read_bytes()
        )
