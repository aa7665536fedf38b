"""A robot as its file describes it, and meshes made by a program."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Union

import numpy as np

from . import _check, _pliant, _toml
from ._check import AnyArray, Array, IntArray, PathLike
from ._values import Value
from .errors import Failure, InputError, arguments_for_options

#: Changes of a robot file: {"mesh.order": 1}, or ["mesh.order=1"] as on the command line.
Changes = Union[Mapping[str, Any], Iterable[str], None]


class Robot:
    """One soft robot: bodies, materials, cables, chambers, supports, markers and a program.

    Made from a file, from text, or from Python with the robot file's own keys::

        robot = pliant.Robot(
            name="bar", length_unit="mm",
            material={"soft": {"youngs_modulus": "1 MPa", "poisson_ratio": 0.45}},
            body=[{"name": "bar", "material": "soft", "geometry": {"box": [[0, 0, 0], [60, 10, 10]]}}],
            fixed=[{"name": "clamp", "box": [[0, 0, 0], [0, 10, 10]]}])

    The reference of the robot file describes every key. Coordinates without a unit are in `length_unit`; everything
    that the module returns is in SI units. A robot is immutable.

    Args:
        description: the keys as a mapping; more may follow as keyword arguments.
        folder: the folder in which files that it names are looked up; default: the current folder.
        changes: as for :meth:`load`.

    Raises:
        InputError: with one line for each problem; `.key` is that of the first.
    """

    __slots__ = ("_robot", "text", "folder", "changes", "_in_python", "_called")

    _robot: _pliant.Robot
    #: How errors name the text of a robot that was not made in Python: by its file, if it has one.
    _called: str
    #: Robot file (TOML).
    text: str
    #: Folder in which files that it names are looked up.
    folder: Path
    #: Changes of the text, "KEY=VALUE" each.
    changes: tuple[str, ...]

    def __init__(
        self,
        description: Mapping[str, Any] | None = None,
        /,
        *,
        folder: PathLike = ".",
        changes: Changes = None,
        **keys: Any,
    ) -> None:
        if description is not None and not isinstance(description, Mapping):
            raise TypeError(
                "a Robot is made of keys, as Robot(name=...) or Robot({...}); a file is read by Robot.load(file), "
                "text by Robot.parse(text)"
            )
        tables = {**(description or {}), **keys}
        self._fill(_toml.document(tables), _folder(folder), changes, True, _TEXT)

    @classmethod
    def load(cls, file: PathLike, changes: Changes = None) -> Robot:
        """Reads a robot file (TOML).

        Args:
            file: its path.
            changes: keys and their new values, as {"mesh.order": 1, "cable.flexor.target.length_ratio": 0.8}.

        Raises:
            InputError: with `.file`, `.line` and `.key` of the first problem, and a line for each.
        """
        path = _check.path(file, "file")
        listed = _changes(changes)
        robot = cls.__new__(cls)
        robot._robot = _pliant.Robot.load(os.fspath(path), listed)
        robot.text = path.read_text(encoding="utf-8")
        robot.folder = path.parent.absolute()
        robot.changes = tuple(listed)
        robot._in_python = False
        robot._called = str(path)
        return robot

    @classmethod
    def parse(cls, text: str, folder: PathLike = ".", changes: Changes = None) -> Robot:
        """Reads a robot from the text of a robot file; files that it names are looked up in `folder`.

        Raises:
            InputError: with `.line` and `.key` of the first problem, and a line for each, which begins with
                "robot text"; `.file` is "".
        """
        if not isinstance(text, str):
            raise TypeError(f"text must be a str, not {type(text).__name__}")
        _check.text(text, "text")
        robot = cls.__new__(cls)
        robot._fill(text, _folder(folder), changes, False, _TEXT)
        return robot

    def _fill(self, text: str, folder: Path, changes: Changes, in_python: bool, called: str) -> None:
        listed = _changes(changes)
        self.text = text
        self.folder = folder.absolute()
        self.changes = tuple(listed)
        self._in_python = in_python
        self._called = called
        with arguments_for_options({"--set ": "changes: "}), self._in_its_words():
            self._robot = _pliant.Robot.parse(text, os.fspath(self.folder), listed)

    @contextmanager
    def _in_its_words(self, file: Path | None = None) -> Iterator[None]:
        """Errors of a robot that was made in Python, or written to a temporary `file`, name no file: nobody has written
        the lines of its text. Those of others name the file that the text is of, if there is one."""
        try:
            with arguments_for_options({} if file else _ARGUMENTS):
                yield
        except Failure as error:
            text = str(file or self.folder / _TEXT)
            if text not in str(error):
                raise
            if file or self._in_python:
                message = re.sub(re.escape(text) + r":(\d+:)? ", "", str(error)).replace(text, "the robot")
                raise type(error)(message, key=error.key) from None
            known = "" if self._called == _TEXT else self._called
            raise type(error)(str(error).replace(text, self._called), known, error.line, error.key) from None

    def changed(self, changes: Changes) -> Robot:
        """The same robot with further changes, as {"mesh.size": "2 mm"}."""
        robot = type(self).__new__(type(self))
        robot._fill(self.text, self.folder, [*self.changes, *_changes(changes)], self._in_python, self._called)
        return robot

    @property
    def name(self) -> str:
        """Name given in the robot file."""
        return self._robot.name

    @property
    def duration(self) -> float:
        """Duration of the program; in seconds for a motion in time."""
        return self._robot.duration

    @property
    def steps(self) -> int:
        """Number of steps of the program."""
        return self._robot.steps

    def __reduce__(self) -> tuple[Any, ...]:
        return _robot_again, (self.text, self.folder, self.changes, self._in_python, self._called)

    def __copy__(self) -> Robot:
        return self

    def __deepcopy__(self, memo: Any) -> Robot:
        return self

    def __repr__(self) -> str:
        return f"<pliant.Robot {self.name!r}>"


#: How the library names a text that has no file, in the folder of the robot.
_TEXT = "robot text"
_ARGUMENTS = {
    "a mesh in memory can only be given by a program; name a file": "pass the mesh in memory, as mesh=pliant.Mesh(...)",
}


def _robot_again(text: str, folder: Path, changes: tuple[str, ...], in_python: bool, called: str = _TEXT) -> Robot:
    robot = Robot.__new__(Robot)
    robot._fill(text, folder, changes, in_python, called)
    return robot


def _folder(folder: PathLike) -> Path:
    """The path of a folder; an empty text is the current one, as for `os.path.dirname`."""
    return Path() if isinstance(folder, str) and folder == "" else _check.path(folder, "folder")


def _changes(changes: Changes) -> list[str]:
    if changes is None:
        return []
    if isinstance(changes, Mapping):
        if not all(isinstance(k, str) for k in changes):
            raise InputError('changes must have texts as keys, as {"mesh.order": 1}')
        return [f"{k}={_toml.value(v, k)}" for k, v in changes.items()]
    if not isinstance(changes, Iterable):
        raise InputError(f'changes must be a dict, as {{"mesh.order": 1}}, or a list of KEY=VALUE, not {changes!r}')
    return _check.texts(changes, "changes")


def _region_names(names: Iterable[str]) -> tuple[str, ...]:
    found = tuple(_check.texts(names, "region_names"))
    if not found:
        raise InputError('region_names is empty; give at least one name, as ("all",)')
    if "" in found:
        raise InputError("one of region_names is empty; bodies refer to regions by their names")
    for name in found:
        if found.count(name) > 1:
            raise InputError(f"region_names has {name!r} twice; each region needs a name of its own")
    return found


def _kept(array: Any) -> Any:
    """A copy that cannot be written."""
    copy = array.copy()
    copy.flags.writeable = False
    return copy


@dataclass(frozen=True, eq=False, init=False)
class Mesh(Value):
    """A tetrahedral mesh for a robot with ``mesh={"file": "memory:"}``.

    The arrays are copied and cannot be written. A model drops points that no tetrahedron uses, and reorders the nodes
    of inverted tetrahedra: its nodes are numbered as in :attr:`Model.rest_positions`, which may differ from `points`.
    """

    #: (points, 3) m.
    points: Array
    #: (tets, 4) or (tets, 10) indices into points; the nodes of edges 01 12 20 03 13 23 last.
    tets: IntArray
    #: (tets,) index into region_names; None: all tetrahedra are in the first region.
    regions: IntArray | None
    #: Names that `region` of a body refers to: at least one, all different.
    region_names: tuple[str, ...]

    def __init__(
        self,
        points: Union[Sequence[Sequence[float]], AnyArray],
        tets: Union[Sequence[Sequence[int]], AnyArray],
        regions: Union[Sequence[int], AnyArray, None] = None,
        region_names: Iterable[str] = ("all",),
    ) -> None:
        put = object.__setattr__
        put(self, "points", _kept(_check.numbers(points, "points", (None, 3))))
        listed = _check.integers(tets, "tets")
        if listed.ndim != 2 or listed.shape[1] not in (4, 10):
            raise InputError(f"tets has shape {listed.shape}; it must have shape (tets, 4) or (tets, 10)")
        put(self, "tets", _kept(listed))
        put(self, "region_names", _region_names(region_names))
        put(self, "regions", None if regions is None else _kept(_check.integers(regions, "regions")))
        if self.regions is not None:
            self._check_regions(self.regions)

    def _check_regions(self, regions: IntArray) -> None:
        if regions.shape != (len(self.tets),):
            raise InputError(f"regions has shape {regions.shape}; it must have shape ({len(self.tets)},)")
        wrong = regions[(regions < 0) | (regions >= len(self.region_names))]
        if wrong.size:
            last = len(self.region_names) - 1
            raise InputError(f"regions has {wrong[0]}; with these region_names it must be from 0 to {last}")

    def __reduce__(self) -> tuple[Any, ...]:  # through __init__, so that what is unpickled cannot be written either
        return type(self), (self.points, self.tets, self.regions, self.region_names)

    def __copy__(self) -> Mesh:
        return self

    def __deepcopy__(self, memo: Any) -> Mesh:
        return self

    def _mesh(self) -> _pliant.Mesh:
        regions = np.empty(0, dtype=np.int32) if self.regions is None else self.regions
        return _pliant.Mesh(self.points, self.tets, regions, list(self.region_names))
