"""The system ``bear.status``: what the streams of a fleet show, as `specs/bear-status.md` describes it.

It imports the kernel and `missionfsm.bear.wire`. Begin with `rules`; `spec` puts the specification together, and
`system` adds its JSON, its alphabet, its mutations and its pictures.
"""
