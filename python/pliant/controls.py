"""Inputs of a robot: how each cable and chamber is driven at one instant."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple, Union

import numpy as np

from . import _check, _pliant
from ._check import AnyArray, Array
from .errors import InputError


class Drive(NamedTuple):
    """How one cable or chamber is driven.

    ========== ======================================================== ======
    by         prescribed quantity                                      unit
    ========== ======================================================== ======
    length     of a cable; a slack cable may be shorter                 m
    tension    of a cable                                               N
    volume     of a chamber                                             m^3
    pressure   of a chamber, above ambient                              Pa
    gas        of a sealed chamber: absolute pressure times volume      J
    ========== ======================================================== ======
    """

    by: str
    value: float


#: Controls as :meth:`Model.step` and others take them: see :meth:`Model.inputs`.
Controls = Union["Inputs", Mapping[str, Any], Sequence[float], AnyArray, None]


class Inputs(Mapping[str, Drive]):
    """All inputs of a robot at one instant: a drive for each cable and chamber, by name, and the time.

    Immutable; :meth:`Model.inputs` makes others. Two are equal if their drives, the order of these and the time are.
    """

    __slots__ = ("names", "time", "_by", "_values")
    __hash__ = None  # type: ignore[assignment]

    #: Cables, then chambers, in the order of the model.
    names: tuple[str, ...]
    #: Program time, which drives supports, loads, gravity and obstacles.
    time: float
    _by: list[str]
    _values: list[float]

    def __init__(self, names: tuple[str, ...], time: float, by: Sequence[str], values: Sequence[float]) -> None:
        kinds = _check.texts(by, "the kinds of drives")
        self._set(
            tuple(_check.texts(names, "the names of drives")),
            _check.number(time, "time"),
            kinds,
            _check.numbers(values, "the values of drives", (len(kinds),)).tolist(),
        )
        if len(self.names) != len(kinds):
            raise InputError(f"{len(kinds)} drives for {len(self.names)} cables and chambers")

    def _set(self, names: tuple[str, ...], time: float, by: list[str], values: list[float]) -> None:
        for name, value in zip(Inputs.__slots__, (names, time, by, values)):
            object.__setattr__(self, name, value)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"inputs do not change: {name} cannot be set; model.inputs(...) makes others")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"inputs do not change: {name} cannot be deleted")

    @property
    def values_SI(self) -> Array:
        """(cables + chambers,) values of the drives, in SI units."""
        return np.array(self._values, dtype=np.float64)

    @property
    def kinds(self) -> tuple[str, ...]:
        """(cables + chambers) kind of each value, as in :class:`Drive`."""
        return tuple(self._by)

    def __getitem__(self, name: str) -> Drive:
        try:
            index = self.names.index(name)
        except ValueError:
            raise KeyError(name) from None
        return Drive(self._by[index], self._values[index])

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Inputs):
            return (self.names, *self._tuple()) == (other.names, *other._tuple())
        return super().__eq__(other)

    def __repr__(self) -> str:
        drives = ", ".join(f"{n}: {b} {v:g}" for n, b, v in zip(self.names, self._by, self._values))
        return f"<pliant.Inputs at {self.time:g}: {drives}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return Inputs, (self.names, self.time, self._by, self._values)

    @classmethod
    def _known(cls, names: tuple[str, ...], time: float, by: Sequence[str], values: Sequence[float]) -> Inputs:
        """Without a look: they come from the library."""
        inputs = cls.__new__(cls)
        inputs._set(names, time, list(by), list(values))
        return inputs

    def _tuple(self) -> tuple[float, list[str], list[float]]:
        return self.time, self._by, self._values


class Rest(NamedTuple):
    """Of an actuator that nothing drives: length (m) or volume (m^3)."""

    cable: bool
    measure: float


# kind in a robot file: (of a cable, drive, unit of the text, value from rest measure and number)
_KINDS = {
    "length": (True, "length", "m"),
    "length_ratio": (True, "length", ""),
    "shortening": (True, "length", "m"),
    "tension": (True, "tension", "N"),
    "volume": (False, "volume", "m^3"),
    "volume_ratio": (False, "volume", ""),
    "volume_change": (False, "volume", "m^3"),
    "pressure": (False, "pressure", "Pa"),
    "gas": (False, "gas", ""),
}


def drive_of(name: str, rest: Rest, wanted: Any) -> tuple[str, float]:
    """A drive from what a user wrote for one actuator."""
    what = f'{"cable" if rest.cable else "chamber"} "{name}"'
    if isinstance(wanted, Drive):
        wanted = {wanted.by: wanted.value}
    if not isinstance(wanted, Mapping) or len(wanted) != 1:
        raise InputError(f"{what}: {_shown(wanted)} does not say what it is; write {_example(rest.cable)}", key=name)
    kind, number = next(iter(wanted.items()))
    known = [k for k, (of_cable, _, _) in _KINDS.items() if of_cable == rest.cable]
    if kind not in known:
        raise InputError(f"{what}: {kind!r} is not known; write one of {', '.join(known)}", key=name)
    _, by, unit = _KINDS[kind]
    if isinstance(number, str):
        if not unit:
            raise InputError(f'{what}: {kind} is a plain number, not "{number}"', key=name)
        try:
            value = _check.number(_pliant.quantity(_check.text(number, "the text"), unit), f'"{number}"')
        except InputError as error:
            raise InputError(f"{what}: {kind}: {error}", key=name) from None
    else:
        value = _check.number(number, f"{what}: {kind}")
    if kind in ("length_ratio", "volume_ratio"):
        value *= rest.measure
    elif kind == "shortening":
        value = rest.measure - value
    elif kind == "volume_change":
        value += rest.measure
    return by, value


def _example(cable: bool) -> str:
    if cable:
        return '{"length_ratio": 0.9}, {"shortening": "4 mm"} or {"tension": "2 N"}'
    return '{"pressure": "20 kPa"}, {"volume_ratio": 1.2} or {"volume_change": "2 ml"}'


def _shown(value: Any) -> str:
    return _check._shown(value)
