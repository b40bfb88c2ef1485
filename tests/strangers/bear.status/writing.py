"""How messages are written as JSON: the ways that the mapping of protobuf to JSON allows."""

from __future__ import annotations

import ctypes
import re
from datetime import UTC, datetime
from typing import Any

from schema import ENUMS, MESSAGES, Json, canonical
from variants import Options


class Writer:
    """Writes response messages in the style that the options ask for."""

    def __init__(self, options: Options) -> None:
        self._options = options

    def write(self, message: str, value: Json) -> Json:
        """The message called `message`, with the content `value`, as it goes over the wire."""
        content = canonical(value) if self._options.on("defaults-omitted") else value
        if not self._options.active:
            return content
        return self._message(message, content)

    def _message(self, message: str, value: Json) -> Json:
        fields = MESSAGES[message]
        written: Json = {}
        for name, member in value.items():
            written[self._name(name)] = self._value(fields.get(name, "any"), member)
        if self._options.on("defaults-written"):
            for name, kind in fields.items():
                if name not in value and kind in DEFAULTS:
                    written[name] = DEFAULTS[kind]
                elif name not in value and kind.startswith("enum "):
                    written[name] = ENUMS[kind[5:]][0]
                elif name not in value and kind.startswith("["):
                    written[name] = []
        return written

    def _name(self, name: str) -> str:
        if self._options.on("snake-names"):
            return re.sub("([A-Z])", lambda match: "_" + match.group(1).lower(), name)
        return name

    def _value(self, kind: str, value: Any) -> Any:
        if kind.startswith("["):
            return [self._value(kind[1:-1], member) for member in value]
        if kind.startswith("{"):
            return {key: self._value(kind[1:-1], member) for key, member in value.items()}
        if kind in MESSAGES and isinstance(value, dict):
            return self._message(kind, value)
        if kind.startswith("enum ") and self._options.on("enums-as-numbers") and value in ENUMS[kind[5:]]:
            return ENUMS[kind[5:]].index(value)
        if kind == "int64" and self._options.on("numbers-as-numbers"):
            return int(value)
        if kind == "float" and self._options.on("floats-rounded") and isinstance(value, (int, float)):
            return ctypes.c_float(value).value
        if kind == "Timestamp" and self._options.on("timestamps-as-objects"):
            return _as_object(value)
        return value


DEFAULTS: dict[str, Any] = {"int": 0, "int64": "0", "float": 0.0, "str": ""}


def _as_object(text: str) -> Json:
    moment = datetime.fromisoformat(text)
    whole = moment.astimezone(UTC)
    return {"seconds": str(int(whole.timestamp())), "nanos": whole.microsecond * 1000}
