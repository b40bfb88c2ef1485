"""The system ``bear.mission``: missions of one robot, as `specs/bear-mission.md` describes them.

It imports the kernel and `missionfsm.bear.wire`. Begin with `rules`; `spec` puts the specification together, and
`system` adds its JSON, its alphabet, its mutations and its pictures.
"""
