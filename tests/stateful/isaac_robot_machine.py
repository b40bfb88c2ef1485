"""The robot's side of the Mission Submission page as a machine of plain rules: codelet, name and connection.

The model is a mission that runs, or none, and what was said of every mission so far.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable
from typing import Any

from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule
from isaac_lines import NO_MESSAGES, Post, Sent, line, text

from missionfsm.isaac.runtime.codelet import Configure, StartBehavior, StopBehavior
from missionfsm.isaac.runtime.robot import Did, RobotCore, RobotEffect, Transmit

FINAL = ("success", "failure")
PERIODICALLY = 1.0
"""Seconds within which what is said periodically is said at least once: the page has no number."""

CONFIGS = st.dictionaries(
    st.sampled_from(["goals.path", "goals.goal_behavior"]),
    st.dictionaries(
        st.sampled_from(["Plan2Generator", "FollowPath"]), st.dictionaries(st.just("speed"), st.integers(1, 3))
    ),
    min_size=1,
)


class RobotMachine(RuleBasedStateMachine):
    """A robot that is sent missions."""

    make_robot: Callable[..., RobotCore] = RobotCore

    @initialize()
    def a_robot(self) -> None:
        """A robot that was started, and is connected."""
        self.robot = self.make_robot("carter-01")
        self.post = Post()
        self.now = 0.0
        self.seldom = 0
        self.made = 0
        self.running: int | None = None
        self.connected = False
        self.said: dict[int, list[str]] = {}
        """The statuses that were sent of every mission."""
        self.unsaid: list[tuple[int, str]] = []
        """What ended while no server was connected."""
        self.behaviors: list[str] = []
        self.configuration: dict[str, Any] = {}
        self.connect()

    # What comes out.

    def heard(self, effects: Iterable[RobotEffect]) -> list[Sent]:
        """What the server is sent, and what the codelet had the robot do."""
        sent = []
        for effect in effects:
            if isinstance(effect, Transmit):
                sent.append(self.post.read(effect.channel, effect.payload))
            elif isinstance(effect, Did):
                if isinstance(effect.action, Configure):
                    self.configuration = json.loads(effect.action.configuration)
                elif isinstance(effect.action, StartBehavior | StopBehavior):
                    self.behaviors.append(type(effect.action).__name__)
        assert self.connected or not sent, "nothing is sent without a connection"
        for one in sent:
            if one.kind == "text":
                # The JsonMockup codelet, Robot Identification: the name, on the name channel.
                assert (one.channel, one.says) == ("name", "carter-01")
            else:
                assert (one.channel, one.kind) == ("mission_status", "status")
                assert one.mission in self.said, "a status of a mission that was never sent"
                self.said[one.mission].append(one.says)
        return [one for one in sent if one.kind == "status"]

    def pass_time(self, seconds: float) -> list[RobotEffect]:
        """Virtual time, stopping wherever the robot has something to do."""
        effects: list[RobotEffect] = []
        self.now += seconds
        while (due := self.robot.next_deadline()) is not None and due <= self.now:
            effects += self.robot.advance(due)
        return [*effects, *self.robot.advance(self.now)]

    def receive(self, some: str) -> list[Sent]:
        """A line from the server."""
        return self.heard(effect for one in text(some) for effect in self.robot.received(one, self.now))

    def ended(self, mission: int, how: str) -> None:
        """Mission Codelet, 4: one final status, now or when a server is there again."""
        if not self.connected:
            self.unsaid.append((mission, how))

    # Mission Codelet

    @rule(config=CONFIGS)
    def mission_arrives(self, config: dict[str, Any]) -> None:
        """Mission Codelet, 1, 2 and preemption: it is configured and started; one that runs has failed."""
        self.made += 1
        mission, old = self.made * ((1 << 64) + 1), self.running
        self.said[mission] = []
        self.behaviors = []
        statuses = [
            (one.mission, one.says) for one in self.receive(line("mission", "mission", mission, json.dumps(config)))
        ]
        if old is not None:
            # The old behavior tree is stopped, and the final status of its mission is FAILURE.
            assert self.behaviors == ["StopBehavior", "StartBehavior"]
            self.ended(old, "failure")
            if self.connected:
                assert statuses[0] == (old, "failure")
                del statuses[0]
        else:
            assert self.behaviors == ["StartBehavior"]
        # RUNNING comes now or with the next period.
        assert statuses in ([], [(mission, "running")])
        for node, components in config.items():
            applied = self.configuration.get(node, {})
            assert all(applied.get(name, {}).items() >= parameters.items() for name, parameters in components.items())
        self.running = mission

    @precondition(lambda self: self.connected and self.seldom < 6)
    @rule(config=st.sampled_from(["rubbish", "[", '"path"', "3"]))
    def unusable_mission_arrives(self, config: str) -> None:
        """A mission whose configuration is none. Open: what becomes of it, and whether it preempts."""
        self.seldom += 1
        self.made += 1
        mission, old = self.made * ((1 << 64) + 1), self.running
        self.said[mission] = []
        for one in self.receive(line("mission", "mission", mission, config)):
            assert (one.mission, one.says) in ((old, "failure"), (mission, "running"), (mission, "failure"))
        gone = old is None or "failure" in self.said[old]
        self.running = None if gone else old
        if "failure" not in self.said[mission]:
            assert gone
            self.running = mission

    @precondition(lambda self: self.running is not None)
    @rule(success=st.booleans())
    def behavior_stops(self, *, success: bool) -> None:
        """Mission Codelet, 4: reportSuccess is SUCCESS, reportFailure is FAILURE, said once."""
        how = FINAL[0] if success else FINAL[1]
        assert self.running is not None
        sent = self.heard(self.robot.behavior_stops(self.now, success=success))
        final = [(one.mission, one.says) for one in sent if one.says in FINAL]
        assert final == ([(self.running, how)] if self.connected else [])
        self.ended(self.running, how)
        self.running = None

    @precondition(lambda self: self.running is None and self.seldom < 6)
    @rule(success=st.booleans())
    def nothing_stops(self, *, success: bool) -> None:
        """Without a mission there is nothing to be said of one."""
        self.seldom += 1
        assert self.heard(self.robot.behavior_stops(self.now, success=success)) == []

    @rule(seconds=st.sampled_from([0.01, 0.1, 0.25, 1.0, 2.5, 5.0]))
    def time_passes(self, seconds: float) -> None:
        """Mission Codelet, 3: RUNNING is sent periodically while the behavior tree runs, and nothing else.

        JsonMockup codelet: so is the name, whatever else is going on.
        """
        effects = self.pass_time(seconds)
        names = [one for one in effects if isinstance(one, Transmit) and one.channel == "name"]
        statuses = self.heard(effects)
        assert {(one.mission, one.says) for one in statuses} <= {(self.running, "running")}
        often = math.floor(seconds / PERIODICALLY)
        assert len(names) >= often * self.connected
        assert len(statuses) >= often * (self.connected and self.running is not None)

    # JsonTcpClient Codelet, Robot Identification

    def connect(self) -> None:
        """Robot Identification: on every connection the name is said anew. What could not be said may follow."""
        self.connected = True
        effects = [*self.robot.connected(self.now), *self.pass_time(PERIODICALLY)]
        sent = [one for one in effects if isinstance(one, Transmit)]
        assert sent[0].channel == "name", "nothing before the name"
        allowed = {*self.unsaid, (self.running, "running")}
        assert {(one.mission, one.says) for one in self.heard(effects)} <= allowed
        self.unsaid = []

    @precondition(lambda self: not self.connected)
    @rule()
    def connection_is_made(self) -> None:
        """The client connects again."""
        self.connect()

    @precondition(lambda self: self.connected)
    @rule()
    def connection_drops(self) -> None:
        """The server is away; the mission goes on."""
        self.behaviors = []
        self.heard(self.robot.disconnected(self.now))
        self.connected = False
        assert self.behaviors == []

    @precondition(lambda self: self.seldom < 6)
    @rule(
        some=st.sampled_from(
            [
                *NO_MESSAGES,
                *[line("other", "mission", 5, "{}")] * 4,  # not the channel of the missions
                line("mission", "text", None, "carter-01"),  # no MissionProto
                line("mission_status", "status", 5, "running"),
            ]
        )
    )
    def something_else_arrives(self, some: str) -> None:
        """What is no MissionProto on the channel of the missions has no effect."""
        self.seldom += 1
        self.behaviors = []
        assert self.receive(some) == []
        assert self.behaviors == []

    # What holds at all times.

    @invariant()
    def one_final_status(self) -> None:
        """Mission Codelet, 3 and 4: RUNNING any number of times, then one final status, then nothing."""
        for mission, statuses in self.said.items():
            assert all(one == "running" for one in statuses[:-1])
            assert mission != self.running or not statuses or statuses[-1] == "running"
