"""Mutation testing of the tester itself: implementations that are broken on purpose, and which of them are found.

It imports the kernel, the oracle and the other tools but for those that draw. Begin with
`missionfsm.tools.mutate.teeth`; `equivalent` finds the mutants that no test can tell from the original.
"""
