"""Conversations that show, between them, every variant."""

from __future__ import annotations

from collections.abc import Callable

from conversations_missions import (
    broken_chain,
    chain,
    configurations,
    diamond,
    float_upstream,
    joins,
    long_limits,
    one_robot,
    order,
    refusals,
    run_limit,
    siblings,
    start_limit,
    twins,
    waiting_limits,
    zero_limits,
)
from conversations_robots import (
    away,
    channels,
    dropped,
    early_and_late,
    many_robots,
    name_channel,
    odd_names,
    repeated_names,
    reports,
    returns,
    rubbish,
    same_name,
    taken_over,
    typed_reports,
)
from talk import Talk

CONVERSATIONS: tuple[Callable[[Talk], None], ...] = (
    chain,
    broken_chain,
    diamond,
    joins,
    one_robot,
    order,
    early_and_late,
    repeated_names,
    odd_names,
    name_channel,
    same_name,
    taken_over,
    dropped,
    returns,
    start_limit,
    run_limit,
    zero_limits,
    long_limits,
    waiting_limits,
    channels,
    reports,
    typed_reports,
    rubbish,
    configurations,
    twins,
    siblings,
    away,
    many_robots,
    refusals,
    float_upstream,
)
"""All conversations."""
