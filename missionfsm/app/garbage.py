"""How often a process looks for what refers to itself in circles and to nothing else."""

import gc

MADE, YOUNG, OLD = 50_000, 20, 20
"""How many values are made before the youngest are looked through, and how often these before the older ones."""


def seldom() -> None:
    """Look for it seldom: values refer to none that refer to them, and are let go of as soon as nobody needs them."""
    gc.freeze()
    gc.set_threshold(MADE, YOUNG, OLD)
