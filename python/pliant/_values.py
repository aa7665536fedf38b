"""Base classes: values with arrays that can be compared, and results that cannot be pickled."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any, ClassVar, TypeVar

import numpy as np

T = TypeVar("T")


def same(a: Any, b: Any) -> bool:
    """True if both have the same type and the same numbers; not-a-number equals itself."""
    if a is b:
        return True
    if isinstance(a, np.ndarray):
        return isinstance(b, np.ndarray) and _same_arrays(a, b)
    if type(a) is not type(b):
        return bool(a == b) if _is_plain(a) and _is_plain(b) else False
    if is_dataclass(a):
        return all(same(getattr(a, f.name), getattr(b, f.name)) for f in fields(a))
    if isinstance(a, (list, tuple)):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(value, b[key]) for key, value in a.items())
    return bool(a == b or (isinstance(a, float) and a != a and b != b))


def _is_plain(value: Any) -> bool:
    return isinstance(value, (bool, int, float, np.number, np.bool_))


def _same_arrays(a: Any, b: Any) -> bool:
    return bool(np.array_equal(a, b, equal_nan=a.dtype.kind in "fc" and b.dtype.kind in "fc"))


class Value:
    """Base of dataclasses with arrays: two are equal if all their members are."""

    __slots__ = ()
    __hash__ = None  # type: ignore[assignment]

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        return same(self, other)


def value_tuple(kind: type[T]) -> type[T]:
    """Decorates a NamedTuple with arrays: two are equal if all their members are."""

    def is_equal(self: Any, other: object) -> bool:
        return isinstance(other, tuple) and len(self) == len(other) and all(map(same, self, other))

    def is_different(self: Any, other: object) -> bool:
        return not is_equal(self, other)

    setattr(kind, "__eq__", is_equal)
    setattr(kind, "__ne__", is_different)
    return kind


class NotPickled:
    """Base of results that exist in this process only; a copy is the same object."""

    __slots__ = ()

    #: What to do instead, for the error.
    _instead: ClassVar[str]

    def __reduce__(self) -> Any:
        raise TypeError(f"a {type(self).__name__} cannot be pickled; {self._instead}")

    def __copy__(self: T) -> T:
        return self

    def __deepcopy__(self: T, memo: Any) -> T:
        return self
