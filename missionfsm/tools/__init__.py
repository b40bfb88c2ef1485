"""What can be done with any system: a folder for each verb of the command line.

They import the kernel, the oracle and the registry of systems, and never a system itself. Begin with
`missionfsm.tools.check.judge`.
"""
