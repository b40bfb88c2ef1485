"""What `docs/grpc.md` shows of grpcurl works: a client that knows nothing but what the server reflects."""

from __future__ import annotations

import argparse
import json
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import grpc
import pytest
from google.protobuf import json_format
from google.protobuf.descriptor import MethodDescriptor
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass
from grpc_reflection.v1alpha.proto_reflection_descriptor_database import ProtoReflectionDescriptorDatabase

import missionfsm
from missionfsm.kernel.codec import JSON

PAGE = (Path(__file__).parents[2] / "docs" / "grpc.md").read_text()
BLOCKS = re.findall(r"<!-- run: grpcurl -->\n```console\n(.*?)```", PAGE, re.DOTALL)
COMMANDS = [
    command.removeprefix("grpcurl ")
    for block in BLOCKS
    for command in block.replace("\\\n", " ").removeprefix("$ ").rstrip().split("\n$ ")
]
WITHIN_S = 10


@pytest.fixture(scope="module")
def target() -> Iterator[str]:
    """A robot with its control service."""
    with missionfsm.serve("bear.mission") as robot:
        yield robot.target


def grpcurl(target: str, command: str) -> list[JSON]:
    """What grpcurl would print for its arguments; of a stream the first message."""
    options = argparse.ArgumentParser()
    options.add_argument("-plaintext", action="store_true", required=True)
    options.add_argument("-d", default="{}")
    options.add_argument("host")
    options.add_argument("what")
    asked = options.parse_args(shlex.split(command))
    assert asked.host == "localhost:50051"
    with grpc.insecure_channel(target) as channel:
        reflected = ProtoReflectionDescriptorDatabase(channel)
        if asked.what == "list":
            return list(reflected.get_services())
        service, _, name = asked.what.rpartition("/")
        method: MethodDescriptor = DescriptorPool(reflected).FindServiceByName(service).FindMethodByName(name)
        request = json_format.Parse(asked.d, GetMessageClass(method.input_type)())
        how = channel.unary_stream if method.server_streaming else channel.unary_unary
        call = how(
            f"/{service}/{name}",
            request_serializer=lambda message: message.SerializeToString(),
            response_deserializer=GetMessageClass(method.output_type).FromString,
        )
        answer = call(request, timeout=WITHIN_S)
        return [json_format.MessageToDict(next(answer) if method.server_streaming else answer)]


def test_there_are_commands() -> None:
    """The page shows calls of the robot and of its control service."""
    assert len(COMMANDS) == 6
    assert {command.rpartition("/")[2] for command in COMMANDS} >= {"CreateMission", "Reset", "Drive", "History"}


@pytest.mark.parametrize("command", COMMANDS)
def test_what_is_shown_of_grpcurl_is_answered(command: str, target: str) -> None:
    """Every call that the page shows is one that the server has, and answers."""
    assert json.dumps(grpcurl(target, command)) != "[]"
