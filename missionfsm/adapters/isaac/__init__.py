"""Isaac's server and robot on real sockets, and a bridge to implementations that speak on sockets.

It imports the kernel, `missionfsm.isaac.wire`, `missionfsm.isaac.runtime` and the other adapters. Begin with
`missionfsm.adapters.isaac.tcp`.
"""
