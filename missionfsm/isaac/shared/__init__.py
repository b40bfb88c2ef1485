"""What both specifications say about lines on the wire: how one is read, and how one is spoilt on purpose.

It imports the kernel and `missionfsm.isaac.wire`. Begin with `missionfsm.isaac.shared.line`.
"""
