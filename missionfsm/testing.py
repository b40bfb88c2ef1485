"""Test suites for implementations of the systems that missionfsm knows: subclass `Suite`, and pytest does the rest.

    from missionfsm.testing import Suite

    class TestMyRobot(Suite):
        system = "bear.mission"
        command = ("node", "my_robot.mjs")

One search is had for each class. It goes on after whatever it finds, so that every operation and every group of rules
passes or fails by itself.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar

import pytest

if TYPE_CHECKING:
    from missionfsm.kernel.subject import Subject
    from missionfsm.tools.conform.survey import Finding, Survey


class Suite:
    """Tests of one implementation: one for each operation, one for each group of rules, one for all together.

    Attributes:
        system: which system it implements.
        command: the adapter to start; where `subject` is overridden it is not looked at.
        examples: conversations of the search in all; ``--missionfsm-examples`` goes before it.
        steps: calls and drives in a conversation, at most.
        seed: the same seed asks the same.
        timeout: seconds that an answer may take.
        readings: readings that have to be followed; the others are found out.
        known: ids of rules that are known to be broken: their tests are expected to fail. One that is not broken any
            more fails `test_everything_is_explained`.
    """

    system: ClassVar[str]
    command: ClassVar[Sequence[str]] = ()
    examples: ClassVar[int] = 120
    steps: ClassVar[int] = 30
    seed: ClassVar[int] = 0
    timeout: ClassVar[float] = 10.0
    readings: ClassVar[Mapping[str, str]] = {}
    known: ClassVar[Collection[str]] = ()
    _found: ClassVar[Survey | str | None] = None

    def subject(self) -> Subject:
        """The implementation under test: by default the adapter behind `command`."""
        from missionfsm.adapters.stdio import Child  # noqa: PLC0415 - only who tests loads it

        return Child(list(self.command), self.timeout)

    def pytest_generate_tests(self, metafunc: pytest.Metafunc) -> None:
        """A test for every operation and for every group of rules of the system."""
        if not {"operation", "group"} & set(metafunc.fixturenames):
            return
        from missionfsm.systems import system  # noqa: PLC0415
        from missionfsm.tools.conform.survey import places  # noqa: PLC0415

        spec = system(self.system).spec
        if "operation" in metafunc.fixturenames:
            metafunc.parametrize("operation", [one for one in places(spec) if one in spec.operations])
        else:
            metafunc.parametrize("group", [one for one in places(spec) if one not in spec.operations])

    @pytest.fixture
    def found(self, request: pytest.FixtureRequest) -> Survey:
        """What the one search came to that all tests of the class share."""
        kept = type(self).__dict__.get("_found")
        if kept is None:
            wanted = request.config.getoption("missionfsm_examples", None) or self.examples
            kept = self._search(wanted)
            type(self)._found = kept  # noqa: SLF001 - its own
        if isinstance(kept, str):
            pytest.fail(kept, pytrace=False)
        return kept

    def _search(self, examples: int) -> Survey | str:
        """What a search comes to, or what is wrong with the adapter."""
        from missionfsm.kernel.subject import SubjectError  # noqa: PLC0415
        from missionfsm.systems import system  # noqa: PLC0415
        from missionfsm.tools.conform.plan import Plan  # noqa: PLC0415
        from missionfsm.tools.conform.survey import survey  # noqa: PLC0415

        try:
            subject = self.subject()
            try:
                return survey(
                    system(self.system),
                    subject,
                    plan=Plan.sharing(examples, self.steps),
                    seed=self.seed,
                    readings=self.readings,
                )
            finally:
                subject.close()
        except SubjectError as error:
            return f"the adapter failed: {error}"

    def test_operation(self, operation: str, found: Survey) -> None:
        """What an operation answers, and what it does, can be explained."""
        self._judge(operation, found)

    def test_rules(self, group: str, found: Survey) -> None:
        """What is promised besides can be explained: moves of a lifecycle, what is streamed, what values there are."""
        self._judge(group, found)

    def test_everything_is_explained(self, found: Survey) -> None:
        """Something was exercised, nothing is wrong that belongs nowhere, and what is known to be broken still is."""
        nowhere = [str(one) for one in found.findings if not one.places]
        if nowhere:
            pytest.fail("\n\n".join(nowhere), pytrace=False)
        if found.verdict.because:
            pytest.fail(str(found.verdict), pytrace=False)
        broken = {rule.id for one in found.findings for rule in one.violation.rules}
        stale = [rule for rule in self.known if rule not in broken]
        if stale:
            pytest.fail(f"known to be broken, and not broken any more: {', '.join(stale)}", pytrace=False)

    def _judge(self, place: str, found: Survey) -> None:
        at = found.at(place)
        unknown = [one for one in at if not self._is_known(one)]
        if unknown:
            pytest.fail("\n\n".join(map(str, unknown)), pytrace=False)
        if at:
            pytest.xfail("; ".join(one.violation.observed for one in at))
        if not found.reached(place):
            pytest.skip(f"nothing of {place} was exercised in {found.verdict.examples} conversations")

    def _is_known(self, finding: Finding) -> bool:
        return any(rule.id in self.known for rule in finding.violation.rules)
