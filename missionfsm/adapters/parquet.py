"""Tables as files of Parquet, which databases and notebooks read."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from typing import Any

from missionfsm.adapters.outputs import write_whole
from missionfsm.kernel.codec import UnreadableError


def refuse_without_parquet() -> None:
    """Raises UnreadableError if no table can be written."""
    _library()


def write_parquet(path: str, columns: Mapping[str, Sequence[Any]], types: Mapping[str, type | None]) -> None:
    """Write a table to a file, whole or not at all; ``-`` is stdout.

    Args:
        types: of what is in each column; None for a list of texts.

    Raises:
        UnreadableError: the library is not installed, or nothing can be written there.
    """
    arrow, parquet = _library()
    kinds: dict[type | None, Any] = {
        str: arrow.string(),
        int: arrow.int64(),
        float: arrow.float64(),
        None: arrow.list_(arrow.string()),
    }
    schema = arrow.schema([(name, kinds[kind]) for name, kind in types.items()])
    file = io.BytesIO()
    parquet.write_table(arrow.table(dict(columns), schema=schema), file)
    write_whole(path, file.getvalue())


def _library() -> tuple[Any, Any]:
    try:
        import pyarrow as pa  # noqa: PLC0415 - an extra
        from pyarrow import parquet  # noqa: PLC0415 - as above
    except ImportError:
        message = "pyarrow is not installed: install missionfsm[parquet] to write Parquet"
        raise UnreadableError(message) from None
    return pa, parquet
