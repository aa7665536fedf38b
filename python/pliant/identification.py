"""Identifies numbers of a robot from measurements: those with which its simulated program agrees best."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple, Union

import numpy as np

from . import _check, _pliant
from ._check import Array, PathLike, Progress
from ._values import NotPickled
from .errors import InputError, MissingFile
from .robot import Mesh, Robot


class Estimate(NamedTuple):
    """Result for one unknown."""

    #: its key in the robot file
    key: str
    #: SI; "" if dimensionless
    unit: str
    #: value at the start of the search
    start: float
    #: value that was found
    value: float
    #: lower end of the 95 % confidence interval; None if the data do not determine one
    low: float | None
    #: upper end, likewise
    high: float | None
    #: True if the value is at a bound
    at_bound: bool
    #: False if no measured value depends on it
    matters: bool


class Comparison(NamedTuple):
    """One measured value beside the simulated ones."""

    #: line of the table
    line: int
    #: program time
    time: float
    #: its column of the table
    quantity: str
    #: unit of the values: that of the column
    unit: str
    #: True if it was left out of the fit, to judge it
    judged: bool
    #: measured value
    measured: float
    #: simulated with the numbers of the given robot
    before: float
    #: simulated with the numbers that were found
    after: float


class FitError(NamedTuple):
    """Root mean square of simulated minus measured values of one unit."""

    #: as in :class:`Comparison`
    unit: str
    #: number of values
    values: int
    #: with the numbers of the given robot
    before: float
    #: with the numbers that were found
    after: float


class Identification(NotPickled):
    """Result of :func:`identify`."""

    __slots__ = ("_before", "_found")
    _instead = "pickle its estimates and changes, or write its folder"

    def __init__(self, robot: Robot, found: _pliant.Identification) -> None:
        self._before = robot
        self._found = found

    @property
    def converged(self) -> bool:
        """False if the search ended after too many trials."""
        return self._found.converged

    @property
    def estimates(self) -> list[Estimate]:
        """Results for the unknowns, in the order of the request."""
        return [Estimate(*e) for e in self._found.estimates()]

    @property
    def correlation(self) -> Array:
        """(estimates, estimates) correlation; NaN for an estimate that is at a bound or does not matter."""
        return np.array(self._found.correlation())

    @property
    def comparisons(self) -> list[Comparison]:
        """Measured and simulated values, in the order of the table."""
        return [Comparison(*c) for c in self._found.comparisons()]

    @property
    def fitted(self) -> list[FitError]:
        """Errors of the values that were fitted, by unit."""
        return [FitError(*e) for e in self._found.fitted()]

    @property
    def judged(self) -> list[FitError]:
        """Errors of the values that were left out of the fit, by unit."""
        return [FitError(*e) for e in self._found.judged()]

    @property
    def warnings(self) -> list[str]:
        """Reasons not to trust the result, one sentence each."""
        return self._found.warnings

    @property
    def trials(self) -> int:
        """Number of programs that were solved."""
        return self._found.trials

    @property
    def changes(self) -> list[str]:
        """KEY=VALUE for each number that was found, as :meth:`Robot.load` takes it."""
        return self._found.changes()

    @property
    def robot(self) -> Robot:
        """The robot with the numbers that were found."""
        return self._before.changed(self.changes)

    @property
    def text(self) -> str:
        """Text for people: tables of the numbers and of the errors."""
        return self._found.text()

    @property
    def summary(self) -> dict[str, Any]:
        """All figures, as in summary.json."""
        found: dict[str, Any] = json.loads(self._found.json())
        return found

    def write(self, folder: PathLike) -> None:
        """Writes the folder that ``pliant identify -o`` writes, whole or not at all."""
        with self._before._in_its_words():
            self._found.write(_check.path_text(folder, "folder"))


def identify(
    robot: Robot,
    unknowns: Iterable[str],
    measured: Union[PathLike, str],
    *,
    judge: str = "nothing",
    mesh: Mesh | None = None,
    progress: Progress | None = None,
) -> Identification:
    """Identifies numbers of a robot by least squares over measured values.

    Programs are solved with ``program.tolerance`` and ``program.max_iterations`` of the robot:
    ``robot.changed({"program.tolerance": 1e-6})`` changes them.

    Args:
        robot: the robot whose program was measured.
        unknowns: keys of the robot file, or "KEY=LOW..HIGH".
        measured: path of a table (CSV) with the columns of ``pliant identify``, or the text of one.
        judge: rows that are left out of the fit, to judge it: "nothing" (or as the column `use` says),
            "every_second" or "second_half".
        mesh: mesh of a robot with ``mesh={"file": "memory:"}``.
        progress: called with (stage, share) some times a second; False cancels.
    """
    if isinstance(measured, str) and "\n" in measured:
        csv, file = measured, b"measured.csv"
    else:
        path = _check.path(measured, "measured")
        csv, file = _read(path), os.fsencode(path)
    _check.one_of(judge, ("nothing", "every_second", "second_half"), "judge")
    owned = _check.instance(robot, Robot, "robot")
    with owned._in_its_words():
        found = _pliant.identify(
            owned._robot,
            _check.texts(unknowns, "unknowns"),
            csv,
            file,
            judge,
            None if mesh is None else _check.instance(mesh, Mesh, "mesh")._mesh(),
            _check.progress(progress),
        )
    return Identification(robot, found)


def _read(path: Path) -> str:
    if os.path.isdir(path):  # Path.is_dir raises for a name that is too long
        raise InputError(f"{path}: is a folder, a file is needed", file=str(path))
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise MissingFile(f"{path}: no such file", str(path)) from None
    except (OSError, UnicodeDecodeError) as error:
        why = error.strerror if isinstance(error, OSError) else "is not a text in UTF-8"
        raise InputError(f"{path}: {why}", file=str(path)) from None
