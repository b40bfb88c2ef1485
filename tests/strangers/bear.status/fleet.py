"""Robot status of a fleet, served on stdin and stdout.

Run without arguments for the base behaviour, with `--choice NAME` for another reading of the page, with
`--bug NAME` for a fault.
"""

from __future__ import annotations

import argparse
import io
import sys

from bugs import BUGS
from choices import CHOICES
from protocol import Conversation
from service import FleetService
from variants import Options


def parse_options(arguments: list[str]) -> Options:
    """The options that the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--choice", choices=[entry.name for entry in CHOICES], action="append", default=[])
    parser.add_argument("--bug", choices=[entry.name for entry in BUGS], action="append", default=[])
    chosen = parser.parse_args(arguments)
    declared = frozenset(entry.name for entry in CHOICES + BUGS)
    return Options(declared, frozenset(chosen.choice + chosen.bug))


def main() -> None:
    """Serve one conversation."""
    options = parse_options(sys.argv[1:])
    source = io.TextIOWrapper(sys.stdin.buffer, encoding="utf-8")
    Conversation(FleetService(options), source, sys.stdout).run()


if __name__ == "__main__":
    main()
