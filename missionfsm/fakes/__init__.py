"""Fakes for the tests of clients: a robot and a fleet in memory, which do what the pages promise.

They import the kernel, the reference and the systems of `missionfsm.bear`. Begin with `missionfsm.fakes.robot`.
"""
