"""Drawing a system: lifecycles, quotients of the state space and task graphs, in seven formats.

It imports the kernel, and of the tools `explore`, `check`, `reference` and the placeholders. Begin with
`missionfsm.tools.draw.gallery`.
"""
