"""The engine: from the lines of a history to the explanations of what was observed, for any specification.

It imports the kernel alone. Begin with `missionfsm.oracle.transcript` and follow an event through `belief` to
`transition` and `successors`.
"""
