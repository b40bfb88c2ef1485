"""Benchmarks measure and print; they run when asked for (`pytest -o addopts= tests/bench -s`); no timing fails them."""

from __future__ import annotations

from pathlib import Path

import pytest


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Skip everything in this folder where benchmarks are skipped."""
    if config.getoption("benchmark_skip"):
        for item in items:
            if Path(__file__).parent in item.path.parents:
                item.add_marker(pytest.mark.skip(reason="a benchmark"))
