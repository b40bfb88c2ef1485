"""The whole language behind one door, for those who write a system: ``from missionfsm.kernel.language import Spec``.

What each name means is said where it is defined.
"""

from __future__ import annotations

from missionfsm.kernel.abstraction import Abstraction
from missionfsm.kernel.alphabet import Alphabet, Bounds, Input, Naming, ScriptStep, as_text, member, new, pick, upcoming
from missionfsm.kernel.chart import Chart
from missionfsm.kernel.codec import JSON, NAMED, Codec, DriveForm, Happening, Malformed, Part, UnreadableError
from missionfsm.kernel.history import Answer, Name
from missionfsm.kernel.matrix import Matrix
from missionfsm.kernel.mutations import (
    MessageMutation,
    StepMutation,
    StepMutator,
    breaks,
    each_sent,
    on_topic,
    sent_last,
    sent_twice,
    unsent,
)
from missionfsm.kernel.picture import Plan, Sketch, every_state
from missionfsm.kernel.possibilities import each_met
from missionfsm.kernel.readings import Ambiguity, Assumption, asked_of_each, declared, meet, to_the_letter
from missionfsm.kernel.rules import (
    DEADLINE_EXCEEDED,
    FAILED_PRECONDITION,
    INVALID_ARGUMENT,
    NOT_FOUND,
    OK,
    RESOURCE_EXHAUSTED,
    Citation,
    Decision,
    Document,
    Operation,
    Rule,
    decide,
    promise,
    refusal,
)
from missionfsm.kernel.shapes import Shapes, record
from missionfsm.kernel.spec import Delivery, Drive, Failure, Invariant, Spec
from missionfsm.kernel.step import Emission, Match, Mismatch, Opening, Step, Unowed
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import Refs
from missionfsm.kernel.text import brief
from missionfsm.kernel.typed import reads
from missionfsm.kernel.whole import shown_whole
from missionfsm.kernel.worlds import WorldForm

__all__ = [
    "DEADLINE_EXCEEDED",
    "FAILED_PRECONDITION",
    "INVALID_ARGUMENT",
    "JSON",
    "NAMED",
    "NOT_FOUND",
    "OK",
    "RESOURCE_EXHAUSTED",
    "Abstraction",
    "Alphabet",
    "Ambiguity",
    "Answer",
    "Assumption",
    "Bounds",
    "Chart",
    "Citation",
    "Codec",
    "Decision",
    "Delivery",
    "Document",
    "Drive",
    "DriveForm",
    "Emission",
    "Failure",
    "Happening",
    "Input",
    "Invariant",
    "Malformed",
    "Match",
    "Matrix",
    "MessageMutation",
    "Mismatch",
    "Name",
    "Naming",
    "Opening",
    "Operation",
    "Part",
    "Plan",
    "Refs",
    "Rule",
    "ScriptStep",
    "Shapes",
    "Sketch",
    "Spec",
    "Step",
    "StepMutation",
    "StepMutator",
    "System",
    "Unowed",
    "UnreadableError",
    "WorldForm",
    "as_text",
    "asked_of_each",
    "breaks",
    "brief",
    "decide",
    "declared",
    "each_met",
    "each_sent",
    "every_state",
    "meet",
    "member",
    "new",
    "on_topic",
    "pick",
    "promise",
    "reads",
    "record",
    "refusal",
    "sent_last",
    "sent_twice",
    "shown_whole",
    "to_the_letter",
    "unsent",
    "upcoming",
]
