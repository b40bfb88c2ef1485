"""Judging what was recorded: the judge, the verdict, and why nothing explains an event.

It imports the kernel, the oracle, the placeholders and the reference. Begin with `missionfsm.tools.check.judge`;
`explain` says how a verdict comes to its rules.
"""
