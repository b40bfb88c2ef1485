"""The messages between server and robot as typed values, strict JSON, and lines on a socket.

It imports the codes, the texts and the errors of the kernel alone. Begin with
`missionfsm.isaac.wire.messages`, then `framing`.
"""
