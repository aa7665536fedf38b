"""Numbers of a robot from measurements on it: those with which its program, simulated, comes nearest."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple, Union

import numpy as np

from . import _check, _pliant
from ._check import Array, PathLike, Progress
from .errors import InputError
from .robot import Mesh, Robot


class Estimate(NamedTuple):
    """A number that was looked for."""

    #: as in the robot file
    key: str
    #: SI; "" of a plain number
    unit: str
    #: where the search began
    start: float
    #: found
    value: float
    #: of the 95 % confidence interval, where the data give one
    low: float | None
    #: likewise
    high: float | None
    #: a bound stops it
    at_bound: bool
    #: False: nothing that was measured depends on it
    matters: bool


class Comparison(NamedTuple):
    """One measured value beside the simulated ones."""

    #: of the table
    line: int
    #: of the program
    time: float
    #: column of the table
    quantity: str
    #: of the values: that of the column
    unit: str
    #: kept out of the fit
    judged: bool
    #: value
    measured: float
    #: simulated with the numbers that the robot had
    before: float
    #: simulated with those that were found
    after: float


class FitError(NamedTuple):
    """Root mean square of simulated minus measured values of one unit."""

    #: as in :class:`Comparison`
    unit: str
    #: how many values there are
    values: int
    #: with the numbers that the robot had
    before: float
    #: with those that were found
    after: float


class Identification:
    """What was found."""

    __slots__ = ("_before", "_found")

    def __init__(self, robot: Robot, found: _pliant.Identification) -> None:
        self._before = robot
        self._found = found

    @property
    def converged(self) -> bool:
        """False: the search ended after too many trials."""
        return self._found.converged

    @property
    def estimates(self) -> list[Estimate]:
        """In the order in which they were asked for."""
        return [Estimate(*e) for e in self._found.estimates()]

    @property
    def correlation(self) -> Array:
        """(estimates, estimates); not a number beside one that is at a bound or does not matter."""
        return np.array(self._found.correlation())

    @property
    def comparisons(self) -> list[Comparison]:
        """In the order of the table."""
        return [Comparison(*c) for c in self._found.comparisons()]

    @property
    def fitted(self) -> list[FitError]:
        """By unit, of the values that were fitted."""
        return [FitError(*e) for e in self._found.fitted()]

    @property
    def judged(self) -> list[FitError]:
        """By unit, of those that were kept out of the fit."""
        return [FitError(*e) for e in self._found.judged()]

    @property
    def warnings(self) -> list[str]:
        """Where the answer should not be trusted, a sentence each."""
        return self._found.warnings

    @property
    def trials(self) -> int:
        """Programs that were solved."""
        return self._found.trials

    @property
    def changes(self) -> list[str]:
        """KEY=VALUE of everything that was found, as :meth:`Robot.load` takes it."""
        return self._found.changes()

    @property
    def robot(self) -> Robot:
        """The robot with what was found."""
        return self._before.changed(self.changes)

    @property
    def text(self) -> str:
        """For people: tables of the numbers and of the errors."""
        return self._found.text()

    @property
    def summary(self) -> dict[str, Any]:
        """All figures, as in summary.json."""
        found: dict[str, Any] = json.loads(self._found.json())
        return found

    def write(self, folder: PathLike) -> None:
        """Writes the folder that ``pliant identify -o`` writes, whole or not at all."""
        self._found.write(_check.path(folder, "folder"))


def identify(
    robot: Robot,
    unknowns: Iterable[str],
    measured: Union[PathLike, str],
    *,
    judge: str = "nothing",
    mesh: Mesh | None = None,
    progress: Progress | None = None,
) -> Identification:
    """Least squares over what was measured.

    Args:
        robot: whose program was measured.
        unknowns: keys of the robot file, or "KEY=LOW..HIGH".
        measured: path of a table (CSV) with the columns of ``pliant identify``, or the text of one.
        judge: rows that are kept out of the fit, to judge it on: "nothing" (or what the column `use` says),
            "every_second" or "second_half".
        mesh: of a robot that says ``mesh={"file": "memory:"}``.
        progress: called with (stage, share) some times a second; False cancels.
    """
    if isinstance(measured, str) and "\n" in measured:
        csv, file = measured, "measured.csv"
    else:
        path = _check.path(measured, "measured")
        csv, file = _read(path), str(path)
    _check.one_of(judge, ("nothing", "every_second", "second_half"), "judge")
    found = _pliant.identify(
        _check.instance(robot, Robot, "robot")._robot,
        _check.texts(unknowns, "unknowns"),
        csv,
        file,
        judge,
        None if mesh is None else _check.instance(mesh, Mesh, "mesh")._mesh(),
        _check.progress(progress),
    )
    return Identification(robot, found)


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        why = error.strerror if isinstance(error, OSError) else "is no text"
        raise InputError(f"{path}: {why}", file=str(path)) from None
