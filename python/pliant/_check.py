"""Checks arguments of functions and converts them; errors are one sentence that names the argument."""

from __future__ import annotations

import operator
import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, Union

import numpy as np

from .errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    AnyArray = NDArray[Any]
    Array = NDArray[np.float64]
    IntArray = NDArray[np.int32]
else:  # numpy.typing takes a tenth of the time to import all of this
    AnyArray = Array = IntArray = np.ndarray
PathLike = Union[str, "os.PathLike[str]"]
#: Called with the current stage and the completed share, 0 to 1; returning False cancels the work.
Progress = Callable[[str, float], Any]

T = TypeVar("T")


def instance(value: Any, kind: type[T], what: str) -> T:
    """`value`, which must be one of `kind`."""
    if isinstance(value, kind):
        return value
    raise TypeError(f"{what} must be a pliant.{kind.__name__}, not {_named(value)}")


def several(values: Any, kind: type[T], what: str) -> list[T]:
    """A list of `kind`, from anything that can be iterated over once."""
    if not is_several(values) or isinstance(values, kind):
        raise InputError(f"{what} must be a list of pliant.{kind.__name__}, not {_named(values)}")
    return [instance(value, kind, f"each of {what}") for value in values]


def is_several(value: Any) -> bool:
    """True for what can be iterated over, except texts and arrays of one number."""
    if isinstance(value, np.ndarray):
        return value.ndim > 0
    return isinstance(value, Iterable) and not isinstance(value, (str, bytes))


def progress(value: Any) -> Any:
    """None, or what can be called."""
    if value is None or callable(value):
        return value
    raise TypeError(f"progress must be callable, as progress(stage, share), not {_named(value)}")


def number(value: Any, what: str) -> float:
    """A finite number."""
    try:
        if isinstance(value, (str, bytes)):
            raise TypeError
        found = float(value)
    except (TypeError, ValueError):
        raise InputError(f"{what} must be a number, not {_shown(value)}") from None
    except OverflowError:
        raise InputError(f"{what} is {_shown(value)}, which is too large") from None
    if not np.isfinite(found):
        raise InputError(f"{what} is {found}, which is not finite")
    return found


def integer(value: Any, what: str) -> int:
    """A whole number that a machine can count to."""
    try:
        found = operator.index(value)
    except TypeError:
        raise InputError(f"{what} must be a whole number, not {_shown(value)}") from None
    if abs(found) > 2**31 - 1:
        raise InputError(f"{what} is {found}, which is too large")
    return found


def numbers(value: Any, what: str, shape: tuple[int | None, ...]) -> Array:
    """An array of numbers; None in the shape is any length."""
    array = _array(value, what)
    if array.ndim != len(shape) or any(w is not None and n != w for n, w in zip(array.shape, shape)):
        wanted = ", ".join("any" if n is None else str(n) for n in shape)
        raise InputError(f"{what} has shape {array.shape}; it must have shape ({wanted}{',' * (len(shape) == 1)})")
    return np.asarray(array, dtype=np.float64, order="C")


def finite(value: Any, what: str, shape: tuple[int | None, ...]) -> Array:
    """As :func:`numbers`, all of them finite."""
    array = numbers(value, what, shape)
    if not np.isfinite(array).all():
        raise InputError(f"{what} has a number that is not finite")
    return array


def seed(value: Any, what: str = "seed") -> int:
    """A whole number of any size that is not negative."""
    try:
        found = operator.index(value)
    except TypeError:
        found = -1
    if found < 0:
        raise InputError(f"{what} must be a whole number that is not negative, not {_shown(value)}")
    return found


def integers(value: Any, what: str) -> IntArray:
    """An array of whole numbers."""
    array = _array(value, what)
    if array.dtype.kind == "f" and not np.array_equal(array, np.floor(array)):
        raise InputError(f"{what} must be whole numbers")
    if array.size and not (array.min() >= -(2**31) and array.max() < 2**31):
        raise InputError(f"{what} has a number that is too large")
    return np.ascontiguousarray(array, dtype=np.int32)


def path(value: Any, what: str) -> Path:
    """A path of a file or folder."""
    if isinstance(value, (str, os.PathLike)):
        found = os.fspath(value)
        if found == "":
            raise InputError(f"{what} is an empty text; write a path")
        if isinstance(found, str) and "\0" not in found:
            try:
                os.fsencode(found)  # names that are not UTF-8 have halves of characters, too, but those that stand for bytes
            except UnicodeEncodeError as error:
                half = ascii(found[error.start])
                raise InputError(f"{what} has {half}, which is no character: it has no place in a path") from None
            return Path(found)
    raise InputError(f"{what} must be a path, not {_shown(value)}")


def path_text(value: Any, what: str) -> str:
    """As :func:`path`, as the extension takes it: it would turn an interrupt within Path.__fspath__ into a TypeError."""
    return os.fspath(path(value, what))


def new_file(value: Any, what: str) -> Path:
    """A path at which a file can be written: its folder is there, and it is no folder itself."""
    found = path(value, what)
    if os.path.isdir(found):
        raise InputError(f"{found}: is a folder; write the name of a file", file=str(found))
    if not os.path.isdir(found.absolute().parent):
        raise InputError(f"{found}: there is no folder {found.parent}", file=str(found))
    return found


def one_of(value: Any, options: Iterable[str], what: str) -> str:
    """One of some words."""
    known = list(options)
    if isinstance(value, str) and value in known:
        return value
    raise InputError(f"{what} is {', '.join(known[:-1])} or {known[-1]}, not {_shown(value)}")


def text(value: Any, what: str) -> str:
    """A text that can be written to a file: without halves of characters (lone surrogates)."""
    if not isinstance(value, str):
        raise InputError(f"{what} must be a text, not {_shown(value)}")
    try:
        value.encode("utf-8")
    except UnicodeEncodeError as error:
        half = ascii(value[error.start])
        raise InputError(f"{what} has {half}, which is no character: it has no place in a text") from None
    return value


def texts(value: Any, what: str) -> list[str]:
    """A list of texts; one alone stands for a list of it."""
    if isinstance(value, str):
        return [text(value, what)]
    if isinstance(value, Iterable):
        found = list(value)
        if all(isinstance(v, str) for v in found):
            return [text(v, what) for v in found]
    raise InputError(f"{what} must be a list of texts, not {_shown(value)}")


def _array(value: Any, what: str) -> AnyArray:
    if isinstance(value, np.ma.MaskedArray) and np.any(value.mask):
        raise InputError(f"{what} has masked entries; give a number for each, as .filled(0) does")
    try:
        array = np.asarray(value)
    except (ValueError, TypeError):
        raise InputError(f"{what} must be an array of numbers; its rows have different lengths") from None
    if array.dtype.kind not in "fiub":
        raise InputError(f"{what} must be an array of numbers, not {_shown(value)}")
    return array


def _named(value: Any) -> str:
    return "None" if value is None else type(value).__name__


def _shown(value: Any) -> str:
    shown = " ".join(repr(value).split())
    return shown if len(shown) <= 40 else shown[:37] + "..."
