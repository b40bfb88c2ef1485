"""``python -m missionfsm`` is the same as ``missionfsm``."""

from missionfsm.cli import main

main()
