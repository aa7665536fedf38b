"""A robot as its file describes it, and meshes that a program has made."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Union

import numpy as np

from . import _check, _pliant, _toml
from ._check import Array, IntArray, PathLike
from .errors import InputError

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

    The reference of the robot file says what every key means. Bare coordinates are in `length_unit`; everything that
    the module gives back is in SI units. A robot never changes.

    Args:
        description: the keys as a mapping; more may follow as keyword arguments.
        folder: where files that it names are sought; default: the current folder.
        changes: as of :meth:`load`.

    Raises:
        InputError: a line for each problem; `.key` is that of the first.
    """

    __slots__ = ("_robot", "text", "folder", "changes", "_in_python")

    #: As a robot file (TOML).
    text: str
    #: Where files that it names are sought.
    folder: Path
    #: "KEY=VALUE" of each change.
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
        self._fill(_toml.document(tables), _check.path(folder, "folder"), changes, True)

    @classmethod
    def load(cls, file: PathLike, changes: Changes = None) -> Robot:
        """Reads a robot file (TOML).

        Args:
            file: its path.
            changes: keys to be changed, as {"mesh.order": 1, "cable.flexor.target.length_ratio": 0.8}.

        Raises:
            InputError: with `.file`, `.line` and `.key` of the first problem, and a line for each.
        """
        path = _check.path(file, "file")
        listed = _changes(changes)
        robot = cls.__new__(cls)
        robot._robot = _pliant.Robot.load(path, listed)
        robot.text = path.read_text(encoding="utf-8")
        robot.folder = path.parent.absolute()
        robot.changes = tuple(listed)
        robot._in_python = False
        return robot

    @classmethod
    def parse(cls, text: str, folder: PathLike = ".", changes: Changes = None) -> Robot:
        """The same of a text; files that it names are sought from `folder`."""
        if not isinstance(text, str):
            raise TypeError(f"text must be a str, not {type(text).__name__}")
        robot = cls.__new__(cls)
        robot._fill(text, _check.path(folder, "folder"), changes, False)
        return robot

    def _fill(self, text: str, folder: Path, changes: Changes, in_python: bool) -> None:
        listed = _changes(changes)
        self.text = text
        self.folder = folder.absolute()
        self.changes = tuple(listed)
        self._in_python = in_python
        try:
            self._robot = _pliant.Robot.parse(text, self.folder, listed)
        except InputError as error:
            if not in_python:
                raise
            # The lines of a text that nobody has written would only mislead.
            message = re.sub(r"^.*robot text:(\d+:)? ", "", str(error), flags=re.MULTILINE)
            raise InputError(message, key=error.key) from None

    def changed(self, changes: Changes) -> Robot:
        """The same robot with more changes: {"mesh.size": "2 mm"}."""
        robot = type(self).__new__(type(self))
        robot._fill(self.text, self.folder, [*self.changes, *_changes(changes)], self._in_python)
        return robot

    @property
    def name(self) -> str:
        """As in the file."""
        return self._robot.name

    @property
    def duration(self) -> float:
        """Of its program, in seconds for a motion in time."""
        return self._robot.duration

    @property
    def steps(self) -> int:
        """Of its program."""
        return self._robot.steps

    def __reduce__(self) -> tuple[Any, ...]:
        return _robot_again, (self.text, self.folder, self.changes, self._in_python)

    def __copy__(self) -> Robot:
        return self

    def __deepcopy__(self, memo: Any) -> Robot:
        return self

    def __repr__(self) -> str:
        return f"<pliant.Robot {self.name!r}>"


def _robot_again(text: str, folder: Path, changes: tuple[str, ...], in_python: bool) -> Robot:
    robot = Robot.__new__(Robot)
    robot._fill(text, folder, changes, in_python)
    return robot


def _changes(changes: Changes) -> list[str]:
    if changes is None:
        return []
    if isinstance(changes, Mapping):
        if not all(isinstance(k, str) for k in changes):
            raise InputError('changes must have texts as keys, as {"mesh.order": 1}')
        return [f"{k}={_toml.value(v, k)}" for k, v in changes.items()]
    return _check.texts(changes, "changes")


@dataclass(frozen=True)
class Mesh:
    """A mesh of tetrahedra for a robot that says ``mesh={"file": "memory:"}`` and names its regions."""

    #: (points, 3) m.
    points: Array
    #: (tets, 4) or (tets, 10) indices into points; the nodes of edges 01 12 20 03 13 23 last.
    tets: IntArray
    #: (tets,) index into region_names; None: all are in the first.
    regions: IntArray | None = None
    #: What `region` of a body names.
    region_names: tuple[str, ...] = field(default=("all",))

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "points", _check.numbers(self.points, "points", (None, 3)))
        tets = _check.integers(self.tets, "tets")
        if tets.ndim != 2 or tets.shape[1] not in (4, 10):
            raise InputError(f"tets has shape {tets.shape}; it must have shape (tets, 4) or (tets, 10)")
        put(self, "tets", tets)
        put(self, "region_names", tuple(_check.texts(self.region_names, "region_names")))
        if self.regions is not None:
            regions = _check.integers(self.regions, "regions")
            if regions.shape != (len(tets),):
                raise InputError(f"regions has shape {regions.shape}; it must have shape ({len(tets)},)")
            put(self, "regions", regions)

    def _mesh(self) -> _pliant.Mesh:
        regions = np.empty(0, dtype=np.int32) if self.regions is None else self.regions
        return _pliant.Mesh(self.points, self.tets, regions, list(self.region_names))
