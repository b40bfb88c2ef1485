"""The control service: how a test in any language sets the scene of a served robot.

Every message is a ``google.protobuf.Struct``, so that a client needs no definitions besides those that every protobuf
library ships. What goes in and comes out is what the adapter protocol's methods take and give.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import grpc
from google.protobuf import descriptor_pb2, descriptor_pool, json_format, struct_pb2

from missionfsm.kernel.codec import JSON

SERVICE = "missionfsm.control.v1.Control"
UNARY = ("Describe", "Reset", "Drive", "Settle")
"""``Describe`` says the system and its drives; ``Reset`` takes ``{"world": {…}}``; ``Drive`` takes a drive and says
whether it happened; ``Settle`` takes ``{"session": …}``, waits until no message is on its way to the streams of that
session, and says how many each was sent."""
STREAMS = ("History",)
"""``History`` gives the lines of the history since the last reset."""
SESSION_KEY, STREAM_KEY = "missionfsm-session", "missionfsm-stream"
"""Metadata by which a subscriber names a stream and the session that it belongs to, for ``Settle``."""
BEGUN_KEY = "missionfsm-begun"
"""Initial metadata of a stream that has begun: what is refused has none, but to a client empty ones look the same."""


def add_to(pool: descriptor_pool.DescriptorPool) -> None:
    """Add the service's descriptor, and that of Struct, to a pool; what is there already is left alone."""
    try:
        pool.FindServiceByName(SERVICE)
    except KeyError:
        pool.AddSerializedFile(struct_pb2.DESCRIPTOR.serialized_pb)
        package, _, name = SERVICE.rpartition(".")
        file = descriptor_pb2.FileDescriptorProto(
            name=f"{SERVICE.replace('.', '/')}.proto",
            package=package,
            syntax="proto3",
            dependency=[struct_pb2.DESCRIPTOR.name],
        )
        service = file.service.add(name=name)
        for method in (*UNARY, *STREAMS):
            service.method.add(
                name=method,
                input_type=".google.protobuf.Struct",
                output_type=".google.protobuf.Struct",
                server_streaming=method in STREAMS,
            )
        pool.AddSerializedFile(file.SerializeToString())


def pack(value: JSON) -> bytes:
    """A JSON object as the bytes of a Struct."""
    return json_format.ParseDict(value, struct_pb2.Struct()).SerializeToString()


def unpack(data: bytes) -> JSON:
    """The JSON object that a Struct is; numbers that are whole are integers again."""
    return _whole(json_format.MessageToDict(struct_pb2.Struct.FromString(data)))


def _whole(value: JSON) -> JSON:
    if isinstance(value, dict):
        return {key: _whole(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_whole(one) for one in value]
    return int(value) if isinstance(value, float) and value.is_integer() else value


class Control:
    """The control service from Python: of a server in this process or, by its address, of any.

    Args:
        target: ``host:port``.
        token: sent as ``authorization: Bearer TOKEN``.
    """

    def __init__(self, target: str, token: str = "") -> None:
        self._channel = grpc.insecure_channel(target)
        self._metadata = (("authorization", f"Bearer {token}"),) if token else ()

    def _ask(self, name: str, value: JSON) -> JSON:
        call = self._channel.unary_unary(f"/{SERVICE}/{name}")
        return unpack(call(pack(value), metadata=self._metadata, wait_for_ready=True))

    def describe(self) -> Mapping[str, JSON]:
        """The system, and the drives that it has."""
        found: Mapping[str, JSON] = self._ask("Describe", {})
        return found

    def reset(self, world: JSON = None) -> None:
        """Begin anew in a world; every stream is forgotten."""
        self._ask("Reset", {"world": world or {}})

    def drive(self, event: str, **fields: JSON) -> bool:
        """Make something happen; False where it does not apply."""
        return bool(self._ask("Drive", {"event": event, **fields})["happened"])

    def history(self) -> Iterable[JSON]:
        """All that was seen since the last reset, as lines of the history format."""
        call = self._channel.unary_stream(f"/{SERVICE}/History")
        return [unpack(one) for one in call(pack({}), metadata=self._metadata)]

    def close(self) -> None:
        """Let go of the connection."""
        self._channel.close()
