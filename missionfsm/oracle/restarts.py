"""Where a robot has restarted by all appearances: a search that takes this for granted has far less to look through.

What was before a restart tells nothing of what comes after it but which calls were on their way, and a message says
that there was one: it names nothing, and its number starts anew. When it happened is open, since calls may have been
answered between the restart and that message; where an answer names what is shown after it, the restart came before the
answer.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from attrs import frozen

from missionfsm.kernel.history import Received, Returned
from missionfsm.kernel.transport import REDELIVERED
from missionfsm.oracle.symbols import Symbol, names_of, relations_of


@frozen
class Restarts:
    """Restarts that are taken for granted, as positions of events.

    Attributes:
        shown: the messages that show them.
        perhaps: the answers before which they may have happened.
        surely: those of which it is known that a restart came before them, at the latest.
    """

    shown: frozenset[int] = frozenset()
    perhaps: frozenset[int] = frozenset()
    surely: frozenset[int] = frozenset()

    def __contains__(self, position: int) -> bool:
        """Whether a restart may have happened before an event."""
        return position in self.shown or position in self.perhaps or position in self.surely


NONE = Restarts()


def apparent_restarts(symbols: Sequence[Symbol], open_before: Iterable[int]) -> Restarts:
    """The restarts that events show by all appearances; none where no message has another number than 0.

    Args:
        symbols: the events.
        open_before: the channels that had shown something before them.
    """
    messages = {at: symbol for at, symbol in enumerate(symbols) if symbol[0] is Received}
    shown = frozenset(at for at, symbol in messages.items() if shows_restart(symbol))
    if not shown or all("zero" in relations_of(symbol) for symbol in messages.values()):
        return NONE
    perhaps: set[int] = set()
    surely: set[int] = set()
    last = -1
    for at, since in _first_shown(messages, shown, open_before):
        answers = [one for one in range(last + 1, at) if symbols[one][0] is Returned]
        later = _named_after(messages, at)
        told = next((one for one in answers if not later.isdisjoint(names_of(symbols[one]))), at)
        perhaps.update(one for one in answers if since < one <= told)
        surely.update({told} - {at})
        last = at
    return Restarts(shown, frozenset(perhaps), frozenset(surely))


def _first_shown(
    messages: Mapping[int, Symbol], shown: Collection[int], open_before: Iterable[int]
) -> Iterator[tuple[int, int]]:
    """Of messages that show restarts the first of each, with the position of the message before it on its channel.

    What another channel shows later, which was open before, is the same restart.
    """
    seen = dict.fromkeys(open_before, -1)
    renewed: dict[int, int] = {}
    last = -1
    for at, symbol in messages.items():
        channel = symbol[-1]
        since, seen[channel] = seen.get(channel, at), at
        if at in shown:
            if since >= last or renewed.get(channel, -1) >= last:
                yield at, since
                last = at
            renewed[channel] = at


def shows_restart(symbol: Symbol) -> bool:
    """Whether a message names nothing, and its number is 0."""
    relations = relations_of(symbol)
    return "zero" in relations and REDELIVERED not in relations and not names_of(symbol)


def _named_after(messages: Mapping[int, Symbol], restart: int) -> set[int]:
    """What the messages behind one that shows a restart name on the same channel, up to the next such one."""
    named: set[int] = set()
    channel = messages[restart][-1]
    for at, symbol in messages.items():
        if at > restart and symbol[-1] == channel:
            if shows_restart(symbol):
                break
            named.update(names_of(symbol))
    return named
