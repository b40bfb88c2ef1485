"""The language: the values and protocols in which the author of a system writes its specification.

It imports nothing of the house. Begin with `missionfsm/app/lamp.py`, a whole small system, then `spec`, `step`, `rules`
and `readings`; `system` puts all of it together, and `language` has every name in one place.
"""
