"""Testing an implementation: which conversation to have with it, what of it matters, and how much was reached.

It imports the kernel, the oracle, and of the tools `check`, `explore`, `reference` and the placeholders. Begin with
`missionfsm.tools.conform.conform`, then `run`.
"""
