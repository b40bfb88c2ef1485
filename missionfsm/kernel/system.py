"""A system as the tools see it: a specification, how its JSON is read, and what is worth trying."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from attrs import evolve, field, frozen

from missionfsm.kernel.alphabet import Alphabet, Bounds, Input, Naming
from missionfsm.kernel.codec import JSON, Codec
from missionfsm.kernel.matrix import Matrix
from missionfsm.kernel.mutations import MessageMutation, StepMutation
from missionfsm.kernel.picture import Plan, Sketch
from missionfsm.kernel.shapes import Shapes, record
from missionfsm.kernel.spec import Spec


@frozen(eq=False)
class System:
    """A specification, how its JSON is read, and what is worth trying (in a world, within bounds).

    Attributes:
        name: what the command line calls it.
        spec: what it does.
        codec: how its JSON is read and written; a codec that names no methods has those of the spec.
        alphabet: (world, bounds) → what is worth trying; by default each call with nothing in it, and each drive.
        naming: how its names are made up and written.
        message_mutations, step_mutations: how an implementation may break its promises, besides the ways that fit
            any system.
        reaching: for rules by id or name, the readings under which their conditions can come about at all.
        sketches, plans: what of it is drawn besides its charts.
        shapes: the JSON Schemas of what its lines carry; by default they may carry anything.
        matrix: its situations, and what should be asked in each; None if the system does not say.
        minutes_at: the size of states, as in `Bounds`, from which it takes minutes to visit all of them; None if no
            such size is known.
        profiles: choices of readings by name: for ambiguities by id, the letters that are left.
    """

    name: str
    spec: Spec
    _codec: Codec = field(factory=Codec)
    _alphabet: Callable[[JSON, Bounds], Alphabet] | None = None
    naming: Naming = Naming()
    message_mutations: tuple[MessageMutation, ...] = ()
    step_mutations: tuple[StepMutation, ...] = ()
    reaching: Mapping[str, Mapping[str, str]] = field(factory=dict)
    sketches: tuple[Sketch, ...] = ()
    plans: tuple[Plan, ...] = ()
    _shapes: Callable[[], Shapes] = Shapes
    profiles: Mapping[str, Mapping[str, str]] = field(factory=dict)
    matrix: Matrix | None = None
    minutes_at: int | None = None
    codec: Codec = field(init=False)  # the one that was given, with the calls and drives of the spec

    def __attrs_post_init__(self) -> None:
        operations = self.spec.operations
        streams = tuple(name for name, one in operations.items() if one.streaming)
        object.__setattr__(self, "codec", self._codec.completed(tuple(operations), streams, tuple(self.spec.drives)))

    def shapes(self) -> Shapes:
        """The JSON Schemas of what its lines carry, those of its drives as the codec has them."""
        drives = {
            name: record({"event": {"const": name}, **members}, ("event", *needed))
            for name, (members, needed) in self.codec.drive_members.items()
        }
        own = self._shapes()
        return evolve(own, drives={**drives, **own.drives})

    def alphabet(self, world: JSON, bounds: Bounds) -> Alphabet:
        """What is worth trying in a world, within bounds."""
        if self._alphabet is not None:
            return self._alphabet(world, bounds)
        calls = tuple(Input(method, {}) for method in self.codec.methods)
        return Alphabet(calls, drives=tuple({"event": name} for name in self.codec.events))

    def chosen(self, profile: str | None, readings: Mapping[str, str]) -> Mapping[str, str]:
        """The readings of a profile, if one is named, but for those that are given. ValueError for one that is not."""
        if profile is None:
            return readings
        if profile not in self.profiles:
            there_are = ", ".join(self.profiles) or "none"
            message = f"{self.name} has no profile {profile}; there are {there_are}"
            raise ValueError(message)
        return {**self.profiles[profile], **readings}
