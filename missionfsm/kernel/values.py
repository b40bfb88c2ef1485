"""Immutable values that are cheap to make.

`value` is `attrs.frozen` for whoever reads or type-checks the code: mypy refuses every assignment to a field. At run
time it is a slotted class without the guard, since the guard makes a value three times as dear to make, and the oracle
and the explorer make little else.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from attrs import frozen as value
else:
    import functools

    import attrs

    value = functools.partial(attrs.define, unsafe_hash=True)

__all__ = ["value"]
