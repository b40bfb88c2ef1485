"""The system ``isaac.server``: the mission server, as `specs/isaac-server.md` describes it.

It imports the kernel, `missionfsm.isaac.wire` and `missionfsm.isaac.shared`; `plans` reads mission files with
`missionfsm.isaac.runtime`. Begin with `rules`; calls and drives are in `effects`, what they bring
about in the rooms that docs/architecture.md lists. `spec` puts the specification together, and `system` adds its JSON,
its alphabet, its mutations and its pictures.
"""
