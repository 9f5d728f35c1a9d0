"""Scenes as TOML, which Python reads and does not write."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from typing import Any

from ._native import Epoch


def text(tables: Mapping[str, Any]) -> str:
    """Tables of a scene by name, each a mapping of keys or a sequence of such mappings, as the text of a scene file."""
    if not isinstance(tables, Mapping):
        raise TypeError(f"tables: a mapping of a scene's tables is needed, not {type(tables).__name__}")
    lines: list[str] = []
    for name, table in tables.items():
        if isinstance(table, Mapping):
            rows, head = [table], f"[{_key(name, name)}]"
        elif _is_sequence(table) and all(isinstance(row, Mapping) for row in table):
            rows, head = list(table), f"[[{_key(name, name)}]]"
        else:
            raise TypeError(f"{name}: a table is a mapping of keys, or a sequence of mappings, not {type(table).__name__}")
        for row in rows:
            lines.append(head)
            lines += [f"{_key(key, name)} = {_value(value, f'{name}.{key}')}" for key, value in row.items() if value is not None]
    return "\n".join(lines) + "\n"


def _key(key: Any, where: str) -> str:
    if not isinstance(key, str):
        raise TypeError(f"{where}: names of tables and keys are str, not {type(key).__name__}")
    return json.dumps(key)


def _value(value: Any, where: str) -> str:
    if hasattr(value, "dtype") and hasattr(value, "tolist") and value.dtype.kind in "biufU":
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        # TOML writes nan and inf as Python does.
        return repr(value)
    if isinstance(value, (str, os.PathLike)):
        return _string(os.fspath(value), where)
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(key, where)} = {_value(item, f'{where}.{key}')}" for key, item in value.items()) + "}"
    if _is_sequence(value):
        return "[" + ", ".join(_value(item, f"{where}[{n}]") for n, item in enumerate(value)) + "]"
    try:
        return _string(Epoch(value).utc, where)
    except TypeError:
        raise TypeError(f"{where}: {type(value).__name__} is nothing that a scene holds") from None


def _string(value: str | bytes, where: str) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{where}: a path of bytes")
    try:
        value.encode()
    except UnicodeEncodeError as error:
        raise ValueError(f"{where}: {value!r} is not UTF-8") from error
    # A JSON string is a valid TOML string, except for U+007F, which TOML requires escaped.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _is_sequence(value: Any) -> bool:
    return isinstance(value, Iterable) and not isinstance(value, (str, bytes, Mapping, Epoch))
