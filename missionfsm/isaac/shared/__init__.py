"""What both specifications say about lines on the wire: how one is read, what is promised of it, how one is spoilt.

It imports the kernel and `missionfsm.isaac.wire`. Begin with `missionfsm.isaac.shared.line`.
"""
