"""Turning a mission's configuration into the text that its message carries."""

from __future__ import annotations

import json
from typing import Any

from mission import Mission
from variants import Variant


def _without_falsy(value: Any) -> Any:
    if isinstance(value, dict):
        kept = {key: _without_falsy(item) for key, item in value.items()}
        return {key: item for key, item in kept.items() if item}
    return value


def _whole_in_lists(value: Any, inside: bool = False) -> Any:
    if isinstance(value, dict):
        return {key: _whole_in_lists(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_whole_in_lists(item, True) for item in value]
    return int(value) if inside and isinstance(value, float) else value


def _through_floats(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _through_floats(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_through_floats(item) for item in value]
    large = isinstance(value, int) and 2**53 < abs(value) < 2**1000
    return int(float(value)) if large else value


def _cut_below(value: Any, levels: int) -> Any:
    if isinstance(value, dict):
        return {key: _cut_below(item, levels - 1) for key, item in value.items()} if levels else {}
    return value


def _numbers_for_booleans(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _numbers_for_booleans(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_numbers_for_booleans(item) for item in value]
    return int(value) if isinstance(value, bool) else value


def config_text(mission: Mission, variant: Variant) -> str:
    """The configuration as JSON text."""
    config = mission.config
    if variant("config-left-out"):
        config = {}
    if variant("config-of-upstream") and mission.upstream:
        config = mission.upstream[0].config
    if variant("config-falsy-dropped"):
        config = _without_falsy(config)
    if variant("config-whole-numbers"):
        config = _whole_in_lists(config)
    if variant("config-large-numbers"):
        config = _through_floats(config)
    if variant("config-cut-deep"):
        config = _cut_below(config, 3)
    if variant("config-booleans-numbers"):
        config = _numbers_for_booleans(config)
    if variant("config-sorted"):
        return json.dumps(config, sort_keys=True)
    text = json.dumps(config, separators=(",", ":"), ensure_ascii=False)
    if variant("config-twice-serialized"):
        text = json.dumps(text)
    if variant("config-letters-lost"):
        text = text.encode("ascii", "replace").decode("ascii")
    return text
