"""The interfaces of Bear Robotics' cloud API: `mission`, `status`, and the messages that both speak in `wire`.

Each system imports the kernel and `wire`; neither imports the other, or the oracle. Begin with
`missionfsm.bear.mission.rules.adding`, beside the page `specs/bear-mission.md`.
"""
