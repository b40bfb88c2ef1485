"""What several screens share: judging recorded files, bridges to sockets, and work on several processes.

It imports everything but the command line and the hooks of pytest. Begin with `missionfsm.app.recorded`.
"""
