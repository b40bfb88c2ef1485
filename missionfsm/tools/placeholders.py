"""Stand-ins in the params of inputs and drives: where names go that a tester picks or makes up.

See `pick`, `new`, `upcoming`, `member` and `as_text` in `missionfsm.kernel.alphabet`.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from typing import Any

from missionfsm.kernel.alphabet import Naming
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Name

MAX_FILLINGS = 24
"""How many ways to fill the slots of one template are thought of at a time."""


def slots(params: JSON) -> dict[int, str]:
    """The slots in params, with the kind of name that each wants."""
    return dict(_slots(params))


def _slots(params: JSON) -> Iterator[tuple[int, str]]:
    if isinstance(params, dict):
        if "$pick" in params:
            yield params["slot"], params["$pick"]
        else:
            yield from itertools.chain.from_iterable(map(_slots, params.values()))
    elif isinstance(params, list):
        yield from itertools.chain.from_iterable(map(_slots, params))


def is_template(params: JSON) -> bool:
    """Whether params hold any stand-in."""
    return any(mark in repr(params) for mark in ("'$pick'", "'$new'", "'$next'", "'$text'"))


def fill(params: JSON, picked: Mapping[int, Any], naming: Naming, serial: int, known: Collection[Any] = ()) -> JSON:
    """Params with names in the place of all stand-ins.

    Args:
        picked: a name for each slot; one that is missing gets a name that is never anything's.
        naming: how names are written and made up.
        serial: what new names are made from.
        known: the names that were given, for the one that would be next.
    """
    if isinstance(params, dict):
        if "$pick" in params:
            name = picked.get(params["slot"])
            return naming.write(naming.make(params["$pick"], 0) if name is None else name)
        if "$new" in params:
            return naming.write(naming.make(params["$new"], serial))
        if "$next" in params:
            taken = [name[1] for name in known if kind_of(name) == params["$next"]]
            return naming.write((params["$next"], max(taken, default=0) + 1))
        if "$member" in params:
            return fill(params["of"], picked, naming, serial, known)[params["$member"]]
        if "$text" in params:
            return json.dumps(fill(params["$text"], picked, naming, serial, known), separators=(",", ":"))
        return {key: fill(value, picked, naming, serial, known) for key, value in params.items()}
    return [fill(value, picked, naming, serial, known) for value in params] if isinstance(params, list) else params


def kind_of(name: Name) -> str | None:
    """What a name is one of; None for plain text."""
    return name[0] if isinstance(name, tuple) else None


def ways(wanted: Mapping[int, str], known: Iterable[Any], naming: Naming) -> Iterator[dict[int, Any]]:
    """Some ways to fill slots with known names, the latest first, and at last with ones that are never anything's."""
    latest = list(known)[::-1]
    choices = [[*(name for name in latest if kind_of(name) == kind), naming.make(kind, 0)] for kind in wanted.values()]
    combined: Callable[..., Iterable[tuple[Any, ...]]] = itertools.product
    for names in itertools.islice(combined(*choices), MAX_FILLINGS):
        yield dict(zip(wanted, names, strict=True))
