"""A mission server and a robot that run, as pure cores: messages and time come in, effects go out.

It imports `missionfsm.isaac.wire` and nothing else of the house, so that it owes nothing to what judges it. Begin
with `missionfsm.isaac.runtime.server` or `missionfsm.isaac.runtime.robot`.
"""
