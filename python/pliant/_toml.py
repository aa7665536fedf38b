"""Python values as TOML: how a robot that is described in Python becomes a robot file."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from . import _check
from .errors import InputError

_BARE = re.compile(r"[A-Za-z0-9_-]+")
_ESCAPES = {'"': '\\"', "\\": "\\\\", "\b": "\\b", "\t": "\\t", "\n": "\\n", "\f": "\\f", "\r": "\\r"}


def text(value: str) -> str:
    """A basic string with its quotes."""
    _check.text(value, f"the text {_check._shown(value)}")
    return '"' + "".join(_ESCAPES.get(c, c if c >= " " and c != "\x7f" else f"\\u{ord(c):04x}") for c in value) + '"'


def key(name: str) -> str:
    """A key, quoted where it must be."""
    return name if _BARE.fullmatch(name) else text(name)


def value(what: Any, where: str) -> str:
    """Anything that TOML has, on one line; `where` is the key, for the error."""
    if isinstance(what, (bool, np.bool_)):
        return "true" if what else "false"
    if isinstance(what, str):
        return text(what)
    if isinstance(what, os.PathLike):
        return text(str(os.fspath(what)))
    if isinstance(what, (int, np.integer)):
        if not -(2**63) <= int(what) < 2**63:
            raise InputError(f"{where}: {what} is too large for a whole number", key=where)
        return str(int(what))
    if isinstance(what, (float, np.floating)):
        if not math.isfinite(what):
            raise InputError(f"{where}: {what} is not a finite number", key=where)
        return repr(float(what))
    if isinstance(what, np.ndarray):
        return value(what.tolist(), where)
    if isinstance(what, Mapping):
        members = (f"{key(k)} = {value(v, f'{where}.{k}')}" for k, v in _members(what, where))
        return "{ " + ", ".join(members) + " }"
    if isinstance(what, (list, tuple)):
        return "[" + ", ".join(value(v, f"{where}[{i}]") for i, v in enumerate(what)) + "]"
    raise InputError(
        f"{where}: {_article(type(what).__name__)} has no place in a robot file; write text, a number, True or False, "
        "a list or a dict",
        key=where,
    )


def document(tables: Mapping[str, Any]) -> str:
    """A whole file, one line for each key of the top level. Keys whose value is None are left out."""
    try:
        return "".join(f"{key(k)} = {value(v, k)}\n" for k, v in _members(tables, ""))
    except RecursionError:
        raise InputError("a list or dict contains itself, or is nested too deeply") from None


def _members(table: Mapping[Any, Any], where: str) -> Iterator[tuple[str, Any]]:
    for k, v in table.items():
        if not isinstance(k, str):
            raise InputError(f"{where or 'the robot'}: the key {k!r} is not text", key=where)
        if v is not None:
            yield k, v


def _article(name: str) -> str:
    return f"an {name}" if name[0] in "aeiouAEIOU" else f"a {name}"
