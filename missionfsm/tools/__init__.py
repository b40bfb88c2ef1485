"""What can be done with any system: a folder for each verb of the command line.

They import the kernel and the oracle, and never a system itself. Begin with
`missionfsm.tools.check.judge`.
"""
