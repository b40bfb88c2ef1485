"""``python -m missionfsm`` is the same as ``missionfsm``."""

import os.path
import sys

if not sys.flags.safe_path and sys.path[0] != os.path.dirname(os.path.dirname(__file__)):  # noqa: PTH120 - loaded anyway
    # The folder in which one works comes first there: a queue.py beside somebody's adapter is not Python's.
    del sys.path[0]

from missionfsm.cli import main

main()
