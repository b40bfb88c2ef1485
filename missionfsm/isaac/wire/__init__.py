"""The messages between server and robot as typed values, strict JSON, and lines on a socket.

It imports nothing of the house. Begin with `missionfsm.isaac.wire.messages`, then `framing`.
"""
