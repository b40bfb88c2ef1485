"""Walking through all states of a small world.

It imports the kernel, the oracle, and of the tools `check`, `reference` and the placeholders. Begin with
`missionfsm.tools.explore.explore`.
"""
