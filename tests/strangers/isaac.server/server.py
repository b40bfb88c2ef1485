"""A mission server behind an adapter: `python3 server.py [--choice NAME | --bug NAME]`."""

from __future__ import annotations

import argparse
import io
import sys

from adapter import Adapter
from bugs import BUGS
from choices import CHOICES
from variants import UnknownVariant, Variant, find


def main() -> int:
    """Read the arguments and serve standard input and output."""
    parser = argparse.ArgumentParser(description="A mission server that speaks the adapter protocol.")
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--choice", metavar="NAME", help="show this reading")
    kind.add_argument("--bug", metavar="NAME", help="show this fault")
    arguments = parser.parse_args()
    name: str | None = None
    try:
        if arguments.choice is not None:
            name = find(CHOICES, arguments.choice).name
        if arguments.bug is not None:
            name = find(BUGS, arguments.bug).name
    except UnknownVariant as unknown:
        parser.error(f"nothing is declared under the name {unknown}")
    label = "mission-server" if name is None else f"mission-server {name}"
    requests = io.TextIOWrapper(sys.stdin.buffer, encoding="utf-8", errors="replace", newline="\n")
    output = io.TextIOWrapper(sys.stdout.buffer, encoding="utf-8", newline="\n")
    Adapter(label, output, Variant(name)).run(requests)
    return 0


if __name__ == "__main__":
    sys.exit(main())
