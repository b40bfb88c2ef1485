"""The system ``isaac.robot``: the robot's side of a mission, as `specs/isaac-robot.md` describes it.

It imports the kernel, `missionfsm.isaac.wire` and `missionfsm.isaac.shared`. Begin with `rules`; `spec` puts the
specification together, and `system` adds its JSON, its alphabet, its mutations and its pictures.
"""
