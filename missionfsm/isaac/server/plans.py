"""Missions that wait for one another as a plan that can be drawn, and the example that the page describes."""

from __future__ import annotations

import json

from missionfsm.isaac.runtime.missionfile import MissionFile, parse
from missionfsm.isaac.runtime.missions import DEFAULT_CHANNEL
from missionfsm.kernel.picture import Plan

FORKLIFTS = """\
{
  "missions": [
    {"robot": "fork01", "config": {"bring-a-pallet": {}}},
    {"robot": "fork02", "config": {"bring-a-pallet": {}}},
    {"robot": "arm01", "config": {"move-the-box": {}}, "upstream": [0, 1]},
    {"robot": "fork01", "config": {"leave": {}}, "upstream": [2]},
    {"robot": "fork02", "config": {"leave": {}}, "upstream": [2]}
  ]
}
"""
"""A mission file for the example of ``MissionSubmission › Mission Dependencies``; what the missions do is made up."""


def plan(name: str, title: str, file: MissionFile) -> Plan:
    """What of a mission file is drawn: of each mission its number, its robot and what it configures."""
    return Plan(
        name,
        title,
        tuple(
            (
                f"mission {index}",
                one.robot or "no robot",
                *([f"on {one.channel}"] if one.channel != DEFAULT_CHANNEL else []),
                *json.loads(one.config),
            )
            for index, one in enumerate(file.missions)
        ),
        tuple(one.upstream for one in file.missions),
    )


def _forklifts() -> Plan:
    file = parse(FORKLIFTS)
    assert isinstance(file, MissionFile), file  # noqa: S101 - it stands above
    return plan("forklifts", "two forklifts and an arm move a box", file)


PLANS = (_forklifts(),)
