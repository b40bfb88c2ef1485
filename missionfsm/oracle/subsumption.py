"""Of many explanations only those that the others do not already stand for.

Four things keep a belief small: explanations that differ in a single question become one; one that has used up more
lost calls than another at the same point is left out; so is one that has to show something more often than another that
may show it as often; and so is one that another can silently become.
"""

from __future__ import annotations

import itertools
import operator
from collections.abc import Hashable, Iterable, Iterator

from missionfsm.kernel.readings import covers, merge
from missionfsm.oracle.explanation import GONE, Explanation, Lost, mentioned_besides, within
from missionfsm.oracle.successors import FocusOf, Place, Successor, Successors, place, place_with_lost


def prune(successors: Successors, found: Iterable[Successor], focus: FocusOf | None = None) -> tuple[Successor, ...]:
    """Those among the explanations that the others do not already stand for.

    Args:
        successors: what one of them can silently become.
        found: the explanations.
        focus: what was observed, where what happens elsewhere is left to later observations.
    """
    found = tuple(found)
    if len(found) <= 1:
        return found
    points: dict[Place, list[Successor]] = {}
    for successor in found:
        here = place_with_lost(successor.explanation)
        points[here] = _widened(successors, points.get(here, []), successor)
    kept = _without_busier(_without_dominated([successor for same in points.values() for successor in same]))
    return tuple(kept) if len(kept) <= 1 else tuple(_without_later(successors, kept, focus))


def _widened(successors: Successors, found: list[Successor], new: Successor) -> list[Successor]:
    """Explanations at one point with one more; those that differ in a single question become one."""
    for position, other in enumerate(found):
        union = merge(other.explanation.assumed, new.explanation.assumed, successors.groups)
        if union is not None:
            if union == other.explanation.assumed:
                return found
            rules = tuple(dict.fromkeys(other.rules + new.rules))
            rest = [*found[:position], *found[position + 1 :]]
            return _widened(successors, rest, Successor(new.explanation.replace(assumed=union), rules))
    return [*found, new]


def _without_later(successors: Successors, found: list[Successor], focus: FocusOf | None) -> Iterator[Successor]:
    """Those that no other can silently become."""
    reached: dict[Place, int] = {}
    for successor in found:
        here = place_with_lost(successor.explanation)
        covered = here in reached and covers(reached[here], successor.explanation.assumed)
        if not covered:
            yield successor
        base = reached[here] if covered else successor.explanation.assumed
        for later in successors.silent(successor.explanation.replace(assumed=base), focus=focus):
            key = place_with_lost(later.explanation)
            if key not in reached or covers(later.explanation.assumed, reached[key]):
                reached[key] = later.explanation.assumed


def _without_dominated(found: list[Successor]) -> list[Successor]:
    """Without those that have used up more lost calls than another at the same point, assuming no less."""
    if not any(successor.explanation.lost for successor in found):
        return found
    kept: dict[Place, list[tuple[int, Lost, Successor]]] = {}
    for successor in sorted(found, key=lambda one: -sum(times for _, _, times in one.explanation.lost)):
        lost = successor.explanation.lost
        others = kept.setdefault(place(successor.explanation), [])
        assumed = successor.explanation.assumed
        if not any(covers(other, assumed) and within(lost, left) for other, left, _ in others):
            others.append((assumed, lost, successor))
    return [successor for others in kept.values() for _, _, successor in others]


def _without_busier(found: list[Successor]) -> list[Successor]:
    """Without those that owe a message more often than another that is the same otherwise and may show it as often."""
    if not any(_offers_again(one.explanation) for one in found):
        return found
    kept: dict[Hashable, list[tuple[tuple[int, ...], Successor]]] = {}
    for successor in found:
        here = successor.explanation
        shapes, times = _duties(here)
        others = kept.setdefault((here.state, here.names, here.calls, here.lost, here.gone, shapes), [])
        if not any(_fewer(less, times) and covers(one.explanation.assumed, here.assumed) for less, one in others):
            others[:] = [
                (more, one)
                for more, one in others
                if not (_fewer(times, more) and covers(here.assumed, one.explanation.assumed))
            ]
            others.append((times, successor))
    return [successor for others in kept.values() for _, successor in others]


def _offers_again(explanation: Explanation) -> bool:
    """Whether a channel owes a message and may show the same again after it."""
    return any(
        after.stays and (one.view, one.names) == (after.view, after.names)
        for channel in explanation.channels
        for one, after in itertools.pairwise(channel.owed)
    )


def _fewer(times: tuple[int, ...], others: tuple[int, ...]) -> bool:
    return all(map(operator.le, times, others))


def _duties(explanation: Explanation) -> tuple[Hashable, tuple[int, ...]]:
    """What the channels owe but for how often, and how often where one may show the same any number of times then."""
    shapes: list[Hashable] = []
    times: list[int] = []
    for channel in explanation.channels:
        runs: list[Hashable] = []
        for _, alike in itertools.groupby(channel.owed, lambda one: (one.view, one.names)):
            run = tuple(alike)
            if run[-1].stays and all(one.only is None and one.shown_as is None for one in run):
                runs.append(run[-1])
                times.append(sum(not one.passing for one in run))
            else:
                runs.append(run)
        shapes.append((channel.name, channel.topic, channel.last, channel.foretold, channel.done, tuple(runs)))
    return tuple(shapes), tuple(times)


def surviving_names(explanations: Iterable[Explanation]) -> dict[int, int]:
    """New numbers for the observed names that are still carried, in the order of first mention.

    A name that is gone in some explanations and was never anything's in others is carried on as well.
    """
    explanations = tuple(explanations)
    seen: dict[int, None] = {}
    for one in explanations:
        seen.update(dict.fromkeys(one.names))
        seen.update(dict.fromkeys(mentioned_besides(one)))
    everywhere = set.intersection(*(set(one.gone) for one in explanations)) if explanations else set()
    seen.update(dict.fromkeys(name for one in explanations for name in one.gone if name not in everywhere))
    return {name: number for number, name in enumerate([name for name in seen if name > GONE])}
