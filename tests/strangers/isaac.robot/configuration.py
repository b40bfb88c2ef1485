"""The configuration that a mission carries: whether the application can be set to it."""

from __future__ import annotations

import json
from typing import Any

from variants import Options


def usable(options: Options, config: Any) -> bool:
    """Whether the application can take over the `config` of a MissionProto."""
    if config is None:
        return not options.on("missing-config-fails")
    if not isinstance(config, dict):
        return False
    serialized = config.get("serialized")
    if serialized is None:
        return not options.on("missing-config-fails")
    if not isinstance(serialized, str):
        return False
    if not serialized.strip():
        return not options.on("empty-config-fails")
    try:
        nodes = json.loads(serialized)
    except (ValueError, RecursionError):
        return options.on("bad-config-runs")
    if nodes is None and options.on("null-config-runs"):
        return True
    if not isinstance(nodes, dict):
        return options.on("any-json-config-runs") or options.on("bad-config-runs")
    if options.on("components-checked"):
        return all(isinstance(components, dict) and components for components in nodes.values())
    return True
