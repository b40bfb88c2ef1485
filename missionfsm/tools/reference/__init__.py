"""A robot, fleet or server computed from its specification: one path through what it allows.

It imports the kernel and the placeholders. Begin with `missionfsm.tools.reference.model`; `subject` puts it behind the
adapter protocol.
"""
