"""Graphs of missions: for each index, the indices it depends on. Iterative, so that long chains are no matter."""

import heapq
from collections import deque
from collections.abc import Sequence


def topological_order(upstream: Sequence[Sequence[int]]) -> list[int]:
    """All indices, upstreams first, otherwise the lowest first. Indices on or behind a cycle are left out."""
    waiting = [len(set(those)) for those in upstream]
    downstream: list[list[int]] = [[] for _ in upstream]
    for index, those in enumerate(upstream):
        for other in set(those):
            downstream[other].append(index)
    ready = [index for index, count in enumerate(waiting) if count == 0]
    heapq.heapify(ready)
    order: list[int] = []
    while ready:
        index = heapq.heappop(ready)
        order.append(index)
        for other in downstream[index]:
            waiting[other] -= 1
            if waiting[other] == 0:
                heapq.heappush(ready, other)
    return order


def cycles(upstream: Sequence[Sequence[int]]) -> list[tuple[int, ...]]:
    """A shortest cycle through the lowest index of every knot of indices that depend on one another."""
    return sorted(_shortest_cycle(upstream, min(knot), knot) for knot in _knots(upstream))


def _shortest_cycle(upstream: Sequence[Sequence[int]], start: int, inside: frozenset[int]) -> tuple[int, ...]:
    came_from: dict[int, int] = {}
    queue = deque([start])
    while queue:
        index = queue.popleft()
        for other in upstream[index]:
            if other == start:
                path = [index]
                while path[-1] != start:
                    path.append(came_from[path[-1]])
                return tuple(path[::-1])
            if other in inside and other not in came_from:
                came_from[other] = index
                queue.append(other)
    return (start,)


def _knots(upstream: Sequence[Sequence[int]]) -> list[frozenset[int]]:
    """The strongly connected components that hold a cycle (Tarjan, without recursion)."""
    number: dict[int, int] = {}
    lowest: dict[int, int] = {}
    stack: list[int] = []
    on_stack: set[int] = set()
    knots: list[frozenset[int]] = []
    for root in range(len(upstream)):
        if root in number:
            continue
        work = [(root, iter(upstream[root]))]
        number[root] = lowest[root] = len(number)
        stack.append(root)
        on_stack.add(root)
        while work:
            index, rest = work[-1]
            other = next(rest, None)
            if other is None:
                work.pop()
                if work:
                    lowest[work[-1][0]] = min(lowest[work[-1][0]], lowest[index])
                if lowest[index] == number[index]:
                    knot = _unstack(stack, on_stack, index)
                    if len(knot) > 1 or index in upstream[index]:
                        knots.append(knot)
            elif other not in number:
                number[other] = lowest[other] = len(number)
                stack.append(other)
                on_stack.add(other)
                work.append((other, iter(upstream[other])))
            elif other in on_stack:
                lowest[index] = min(lowest[index], number[other])
    return knots


def _unstack(stack: list[int], on_stack: set[int], until: int) -> frozenset[int]:
    knot: list[int] = []
    while not knot or knot[-1] != until:
        knot.append(stack.pop())
        on_stack.discard(knot[-1])
    return frozenset(knot)
