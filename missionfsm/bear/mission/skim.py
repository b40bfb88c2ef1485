"""Status messages as texts: what differs from one to the next, found without reading them as JSON."""

from __future__ import annotations

import re

from missionfsm.bear.wire.protojson import USUAL_TIMESTAMP
from missionfsm.kernel.codec import Skimmed

_METADATA = re.compile(
    rb'{"metadata":{"timestamp":"%b","sequenceNumber":("?)([1-9][0-9]{0,17})\1},' % USUAL_TIMESTAMP.encode("ascii")
)
"""How nearly all messages begin."""
_NAME, _OTHER_NAME = b'"missionId":"', b'"mission_id"'


def skim(text: bytes) -> Skimmed | None:
    """The mission ids of a status message, its sequence number, and the text without them."""
    metadata = _METADATA.match(text)
    if metadata is None or _OTHER_NAME in text:
        return None
    pieces = text[metadata.end() :].split(_NAME)
    names = []
    for number in range(1, len(pieces)):
        name, _, pieces[number] = pieces[number].partition(b'"')
        names.append(name)
    return names, ((None, int(metadata[2])),), _NAME.join(pieces)
