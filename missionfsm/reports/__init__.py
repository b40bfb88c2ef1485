"""The formats in which verdicts are written to files: a room for each, whose `written` makes the bytes.

They import the kernel, the tools, the pages and the registry of systems. Begin with `missionfsm.reports.formats`,
where they are listed.
"""
