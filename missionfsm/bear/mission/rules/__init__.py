"""The Errors tables of the Mission page: every row as the conditions that its sentence names, a file for each theme.

A refusal that several calls share cites the table of the first; `operations.py` has it cite the table of each. The
files import the kernel, `readings`, and what a state and a call are. Begin with `adding`.
"""
