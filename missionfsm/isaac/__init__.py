"""Isaac SDK's missions: the systems `server` and `robot` with what they share, and in `runtime` two programs that run.

The two systems import the kernel, `wire` and `shared`; what runs imports `wire` alone. Begin with
`missionfsm.isaac.server.rules`, beside the page `specs/isaac-server.md`.
"""
