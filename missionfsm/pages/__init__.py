"""Reports, the explorer and the results of mutation testing, as single HTML pages.

They import the kernel, the oracle and the tools. Begin with `missionfsm.pages.report`.
"""
