"""The system ``isaac.server``: the mission server, as `specs/isaac-server.md` describes it.

It imports the kernel, `missionfsm.isaac.wire` and `missionfsm.isaac.shared`; `plans` reads mission files with
`missionfsm.isaac.runtime`. Begin with `rules`; what happens is in `lifecycle`, `connections`,
`reports`, `dispatch` and `time`, `spec` puts the specification together, and `system` adds its JSON, its alphabet, its
mutations and its pictures.
"""
