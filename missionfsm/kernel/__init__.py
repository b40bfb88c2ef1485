"""The language: the values and protocols in which the author of a system writes its specification.

It imports nothing of the house. Begin with `missionfsm.kernel.spec`, then `rules` and `readings`; `system` puts all
of it together.
"""
