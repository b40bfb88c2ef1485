"""The control service: how a test in any language sets the scene of a served robot.

Every message is a ``google.protobuf.Struct``, so that a client needs no definitions besides those that every protobuf
library ships. What goes in and comes out is what the adapter protocol's methods take and give.
"""

from __future__ import annotations

from typing import Any

from google.protobuf import descriptor_pb2, descriptor_pool, json_format, struct_pb2

from missionfsm.kernel.codec import JSON

SERVICE = "missionfsm.control.v1.Control"
UNARY = ("Describe", "Reset", "Drive")
"""``Describe`` says the system, its world and its drives; ``Reset`` takes ``{"world": {…}}``; ``Drive`` a drive."""
STREAMS = ("History",)
"""``History`` gives the lines of the history since the last reset."""


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


def unpack(data: bytes) -> Any:  # noqa: ANN401 - JSON
    """The JSON object that a Struct is; numbers that are whole are integers again."""
    return _whole(json_format.MessageToDict(struct_pb2.Struct.FromString(data)))


def _whole(value: Any) -> Any:  # noqa: ANN401 - JSON
    if isinstance(value, dict):
        return {key: _whole(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_whole(one) for one in value]
    return int(value) if isinstance(value, float) and value.is_integer() else value
