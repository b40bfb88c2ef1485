"""Protobuf descriptors of the Bear API, built at run time from the one table of the wire.

No generated code and no compiler are needed, and every client that was generated from the vendor's own definitions is
wire-compatible. The vendor's packages use one another's messages in circles that only files can undo, so that every
message and enum that stands in no other has a file of its own here.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NewType

from google.protobuf import any_pb2, descriptor_pb2, descriptor_pool, json_format, message_factory, timestamp_pb2
from google.protobuf.message import DecodeError, Message

from missionfsm.adapters.grpc import usual
from missionfsm.bear.wire.enums import ENUMS
from missionfsm.bear.wire.fields import MESSAGES, PACKAGE, Field
from missionfsm.bear.wire.methods import METHODS, Method
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.text import brief

_Proto = descriptor_pb2.FieldDescriptorProto
_SCALARS = {
    "string": _Proto.TYPE_STRING,
    "int32": _Proto.TYPE_INT32,
    "int64": _Proto.TYPE_INT64,
    "float": _Proto.TYPE_FLOAT,
    "bool": _Proto.TYPE_BOOL,
}
_WELL_KNOWN = {
    "google.protobuf.Timestamp": timestamp_pb2.DESCRIPTOR,
    "google.protobuf.Any": any_pb2.DESCRIPTOR,
}
Wire = NewType("Wire", bytes)
"""A message in the binary form of protobuf."""


def _outermost(name: str) -> str:
    """``core.MissionState`` for ``core.MissionState.State``: what stands in no other message."""
    package, _, rest = name.rpartition(".")
    return _outermost(package) if package in MESSAGES else f"{package}.{rest}"


def _path(name: str) -> str:
    return f"{PACKAGE}.{name}".replace(".", "/") + ".proto"


def _package(name: str) -> str:
    return f"{PACKAGE}.{name.rpartition('.')[0]}"


def _used(name: str) -> Iterator[str]:
    """The files that the file of a message needs."""
    for message, fields in MESSAGES.items():
        if _outermost(message) == name:
            for field in fields:
                if field.type in _WELL_KNOWN:
                    yield _WELL_KNOWN[field.type].name
                elif field.type not in _SCALARS and _outermost(field.type) != name:
                    yield _path(_outermost(field.type))


def _fill(proto: descriptor_pb2.DescriptorProto, name: str) -> None:
    """Put the fields of a message into its descriptor, and what stands inside it."""
    proto.name = name.rpartition(".")[2]
    fields = MESSAGES[name]
    oneofs = _oneofs(fields)
    for oneof in dict.fromkeys(oneofs.values()):
        proto.oneof_decl.add(name=oneof)
    order = {oneof: index for index, oneof in enumerate(dict.fromkeys(oneofs.values()))}
    for field in fields:
        one = proto.field.add(name=field.name, number=field.number)
        one.label = _Proto.LABEL_REPEATED if field.label in ("repeated", "map") else _Proto.LABEL_OPTIONAL
        if field.label == "map":
            one.type, one.type_name = _Proto.TYPE_MESSAGE, f".{PACKAGE}.{name}.{_entry(proto, field)}"
        else:
            _typed(one, field.type)
        if field.name in oneofs:
            one.oneof_index = order[oneofs[field.name]]
        if field.label == "optional":
            one.proto3_optional = True
    for inner in (inner for inner in MESSAGES if inner.rpartition(".")[0] == name):
        _fill(proto.nested_type.add(), inner)
    for inner in (inner for inner in ENUMS if inner.rpartition(".")[0] == name):
        _fill_enum(proto.enum_type.add(), inner)


def _oneofs(fields: Sequence[Field]) -> dict[str, str]:
    """Field to the oneof that it is in: those of the definition first, then one for each field that is optional."""
    own = {field.name: field.oneof for field in fields if field.oneof}
    return own | {field.name: f"_{field.name}" for field in fields if field.label == "optional"}


def _entry(proto: descriptor_pb2.DescriptorProto, field: Field) -> str:
    """The message that stands for an entry of a map."""
    entry = proto.nested_type.add(name="".join(word.capitalize() for word in field.name.split("_")) + "Entry")
    entry.options.map_entry = True
    for number, (name, kind) in enumerate((("key", "string"), ("value", field.type)), 1):
        one = entry.field.add(name=name, number=number, label=_Proto.LABEL_OPTIONAL)
        _typed(one, kind)
    return entry.name


def _typed(one: descriptor_pb2.FieldDescriptorProto, kind: str) -> None:
    if kind in _SCALARS:
        one.type = _SCALARS[kind]
    else:
        one.type = _Proto.TYPE_ENUM if kind in ENUMS else _Proto.TYPE_MESSAGE
        one.type_name = f".{kind}" if kind in _WELL_KNOWN else f".{PACKAGE}.{kind}"


def _fill_enum(proto: descriptor_pb2.EnumDescriptorProto, name: str) -> None:
    proto.name = name.rpartition(".")[2]
    for value, number in ENUMS[name].items():
        proto.value.add(name=value, number=number)


def _files() -> Iterator[descriptor_pb2.FileDescriptorProto]:
    """A file for every outermost message and enum, then one for every service."""
    for name in (*MESSAGES, *ENUMS):
        if _outermost(name) == name:
            file = descriptor_pb2.FileDescriptorProto(name=_path(name), package=_package(name), syntax="proto3")
            file.dependency.extend(dict.fromkeys(_used(name)))
            if name in MESSAGES:
                _fill(file.message_type.add(), name)
            else:
                _fill_enum(file.enum_type.add(), name)
            yield file
    for service in dict.fromkeys(method.service for method in METHODS):
        calls = [method for method in METHODS if method.service == service]
        file = descriptor_pb2.FileDescriptorProto(name=_path(service), package=_package(service), syntax="proto3")
        file.dependency.extend(dict.fromkeys(_path(name) for one in calls for name in (one.request, one.response)))
        proto = file.service.add(name=service.rpartition(".")[2])
        for one in calls:
            proto.method.add(
                name=one.name,
                input_type=f".{PACKAGE}.{one.request}",
                output_type=f".{PACKAGE}.{one.response}",
                server_streaming=one.streams,
            )
        yield file


@functools.cache
def pool() -> descriptor_pool.DescriptorPool:
    """The descriptors of every message, enum and service of the table."""
    found = descriptor_pool.DescriptorPool()
    for well_known in _WELL_KNOWN.values():
        found.AddSerializedFile(well_known.serialized_pb)
    waiting = {file.name: file for file in _files()}

    def add(name: str) -> None:
        file = waiting.pop(name, None)
        if file is not None:
            for needed in file.dependency:
                add(needed)
            found.AddSerializedFile(file.SerializeToString())

    for name in tuple(waiting):
        add(name)
    return found


@functools.cache
def message_class(name: str) -> type[Message]:
    """The class of a message, given its name in the table."""
    return message_factory.GetMessageClass(pool().FindMessageTypeByName(f"{PACKAGE}.{name}"))


SERVICES: Mapping[str, str] = {"bear.mission": "services.robot.APIService", "bear.status": "services.cloud.APIService"}
"""System to the service that has its calls."""


def methods(system: str) -> Mapping[str, Method]:
    """The calls of a system by name. Raises KeyError for a system that is not of the Bear API."""
    return {one.name: one for one in METHODS if one.service == SERVICES[system]}


def path(method: Method) -> str:
    """The path of a call in gRPC."""
    return f"/{PACKAGE}.{method.service}/{method.name}"


class NotOnTheWireError(ValueError):
    """A JSON value that no binary message says, or bytes that are no message; the text says why."""


_REFUSALS = (
    *(json_format.ParseError, ValueError, TypeError, AttributeError, RecursionError),
    *(ArithmeticError, SystemError),  # of infinity as an enum; of a text that is no Unicode as an enum
)
"""What json_format raises for JSON that is no message."""


def encode(name: str, value: JSON) -> Wire:
    """The bytes of a message, given its protobuf JSON.

    Raises:
        NotOnTheWireError: binary protobuf cannot say it: two members of a oneof, an enum by a name that it has not, …
    """
    if not isinstance(value, dict):
        raise NotOnTheWireError(f"{brief(value)} is no message")
    try:
        return Wire(message_class(name)(**usual.fields(name, value)).SerializeToString())
    except (ValueError, TypeError):
        pass  # it is not written as usual, or it is no message
    try:
        message = json_format.ParseDict(value, message_class(name)(), descriptor_pool=pool())
        return Wire(message.SerializeToString())
    except _REFUSALS as error:
        raise NotOnTheWireError(str(error).splitlines()[0] if str(error) else type(error).__name__) from None


def decode(name: str, data: bytes) -> JSON:
    """The protobuf JSON of a message, given its bytes; what the message does not have is left out, see `unknown`.

    Raises:
        NotOnTheWireError: the bytes are no message of that kind.
    """
    try:
        message = message_class(name).FromString(data)
        return json_format.MessageToDict(message, descriptor_pool=pool())
    except (DecodeError, json_format.SerializeToJsonError, ValueError, TypeError, KeyError) as error:
        raise NotOnTheWireError(str(error).splitlines()[0] if str(error) else type(error).__name__) from None


def unknown(name: str, data: bytes) -> tuple[str, ...]:
    """Where a message has fields that the table does not know: a path and a field number for each."""
    return tuple(_unknown(message_class(name).FromString(data), ""))


def _unknown(message: Any, at: str) -> Iterator[str]:  # noqa: ANN401 - a message of a class made at run time
    from google.protobuf.unknown_fields import UnknownFieldSet  # noqa: PLC0415 - few need it

    for field in UnknownFieldSet(message):
        yield f"{at}{field.field_number}"
    for descriptor, value in message.ListFields():
        if descriptor.message_type is None:
            continue
        if descriptor.message_type.GetOptions().map_entry:
            inner = value.values() if descriptor.message_type.fields_by_name["value"].message_type else ()
        else:
            inner = value if descriptor.is_repeated else (value,)
        for one in inner:
            yield from _unknown(one, f"{at}{descriptor.name}.")
