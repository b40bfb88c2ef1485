"""Walking through all states of a small world.

It imports the kernel and the placeholders. Begin with `missionfsm.tools.explore.explore`.
"""
