"""Start the robot: the base, one choice, or one bug."""

from __future__ import annotations

import argparse
import io
import sys

import variants
from adapter import Adapter
from service import Robot


def main() -> None:
    """Read the command line and serve stdin."""
    parser = argparse.ArgumentParser(description=__doc__)
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--choice", choices=sorted(variants.CHOICES), metavar="NAME", help="a legitimate variant")
    which.add_argument("--bug", choices=sorted(variants.BUGS), metavar="NAME", help="a fault")
    options = parser.parse_args()
    robot, name = Robot, "base"
    if options.choice:
        robot, name = variants.CHOICES[options.choice].robot, options.choice
    elif options.bug:
        robot, name = variants.BUGS[options.bug].robot, options.bug
    if isinstance(sys.stdin, io.TextIOWrapper):
        sys.stdin.reconfigure(encoding="utf-8", errors="replace")
    Adapter(robot, f"robot {name}", sys.stdout).serve(sys.stdin)


if __name__ == "__main__":
    main()
