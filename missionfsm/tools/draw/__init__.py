"""Drawing a system: lifecycles, quotients of the state space and task graphs, in seven formats.

It imports the kernel and `missionfsm.tools.explore`. Begin with `missionfsm.tools.draw.gallery`.
"""
