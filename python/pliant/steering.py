"""Inverse kinematics and workspaces: inputs that meet goals, and the positions that markers can reach."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple, Union, overload

import numpy as np
import numpy.typing as npt

from . import _check, _pliant
from ._check import Array, IntArray, PathLike, Progress
from ._pliant import StepResult
from ._values import NotPickled, Value, value_tuple
from .controls import Inputs
from .errors import InputError
from .model import Model
from .results import Observation, observation


def _place(index: int, count: int, what: str) -> int:
    """The place that an index, which may count from the end, means."""
    wanted = _check.integer(index, "index")
    wanted += count if wanted < 0 else 0
    if not 0 <= wanted < count:
        raise IndexError(f"there is no {what} {index}; there are {count}")
    return wanted


class SteeredInput(NamedTuple):
    """An actuator with a range, which :func:`inverse` and :func:`workspace` may move."""

    #: name of the cable or chamber
    name: str
    #: SI unit of its target; "" for a ratio
    unit: str
    #: lower end of its range
    low: float
    #: upper end of its range
    high: float


@value_tuple
class GoalResult(NamedTuple):
    """Result for one goal at a waypoint."""

    #: as in the robot file
    name: str
    #: True if the error is within the tolerance of the goal
    reached: bool
    #: error in `unit` (m, rad or N); the largest of several markers
    error: float
    #: unit of the error
    unit: str
    #: (n, 3) wanted positions; for a plane a point and its normal; a unit direction; or a force
    wanted: Array
    #: (n, 3) positions of the markers that were reached; a direction; or a force
    got: Array


@dataclass(frozen=True, eq=False)
class Waypoint(Value):
    """Result for one waypoint."""

    #: True if all its goals are reached
    reached: bool
    #: program time, which sets everything that is not an input
    time: float
    #: in the order of the robot file
    goals: list[GoalResult]
    #: values of the inputs by name, in the SI units of their targets
    inputs: dict[str, float]
    #: why it is not reached, one sentence each: limits of actuators, goals in other directions than the actuators move
    #: the robot in, or that the search was cancelled; empty if it is reached
    limits: list[str]
    #: result of the solver
    result: StepResult
    #: measurable quantities of the equilibrium
    observed: Observation
    #: (nodes, 3) m
    positions: Array
    #: number of equilibria that were solved for
    forward_solutions: int
    #: wall time of the search, s
    wall_s: float


class InverseResult(NotPickled):
    """Result of :func:`inverse`: a sequence of :class:`Waypoint`. A slice is a list of them."""

    __slots__ = ("model", "_result")
    _instead = "pickle its waypoints, as list(result), or write its folder"

    def __init__(self, model: Model, result: _pliant.InverseResult) -> None:
        self.model = model
        self._result = result

    @property
    def reached(self) -> bool:
        """True if all waypoints are reached."""
        return self._result.reached

    @property
    def message(self) -> str:
        """Why waypoints are missing; otherwise empty."""
        return self._result.message

    @property
    def notes(self) -> list[str]:
        """Remarks on the search, one sentence each."""
        return self._result.notes

    @property
    def inputs(self) -> list[SteeredInput]:
        """The inputs that were moved."""
        return [SteeredInput(*i) for i in self._result.inputs()]

    @property
    def waypoints_wanted(self) -> int:
        """Number of waypoints of the goals."""
        return self._result.waypoints_wanted

    @property
    def text(self) -> str:
        """Text for people: a line for each waypoint, with the limits of those that are not reached."""
        return self._result.text()

    @property
    def summary(self) -> dict[str, Any]:
        """All figures, as in inverse.json."""
        found: dict[str, Any] = json.loads(self._result.json())
        return found

    def write(self, folder: PathLike, *, progress: Progress | None = None) -> list[str]:
        """Writes the folder that ``pliant inverse -o`` writes, whole or not at all.

        Returns:
            Warnings where the written program, run from rest, does not lead to the waypoints that were found.
        """
        with self.model.robot._in_its_words():
            return self._result.write(_check.path_text(folder, "folder"), _check.progress(progress))

    def __len__(self) -> int:
        return self._result.waypoint_count

    @overload
    def __getitem__(self, index: int) -> Waypoint: ...
    @overload
    def __getitem__(self, index: slice) -> list[Waypoint]: ...

    def __getitem__(self, index: Union[int, slice]) -> Union[Waypoint, list[Waypoint]]:
        if isinstance(index, slice):
            return [self[k] for k in range(len(self))[index]]
        wanted = _place(index, len(self), "waypoint")
        reached, time, goals, inputs, limits, result, seen, positions, solutions, wall_s = self._result.waypoint(wanted)
        named = dict(zip((i.name for i in self.inputs), inputs))
        listed = [GoalResult(*g) for g in goals]
        return Waypoint(
            reached, time, listed, named, limits, result, observation(seen), positions, solutions, wall_s
        )

    def inputs_at(self, index: int) -> Inputs:
        """All inputs of the robot at a waypoint, for :meth:`Model.step`: the values that were found, and for everything
        that is not steered those of the program at its time."""
        return self.model._inputs_of(self._result.inputs_at(_place(index, len(self), "waypoint")))

    def __iter__(self) -> Iterator[Waypoint]:
        return (self[k] for k in range(len(self)))

    def __repr__(self) -> str:
        reached = sum(w.reached for w in self)
        return f"<pliant.InverseResult of {self.model.robot.name!r}: {reached} of {self.waypoints_wanted} reached>"


def inverse(model: Model, *, starts: int = 6, progress: Progress | None = None) -> InverseResult:
    """Finds the inputs that meet the goals of the robot file, waypoint by waypoint; every result is an equilibrium. A
    goal that cannot be reached is not an error: the search ends at the nearest point.

    Args:
        model: a model of a robot with goals, and a range for each actuator that may be moved.
        starts: number of further starting points, spread over the ranges, that are tried if the search from rest does
            not reach the first waypoint.
        progress: called with (stage, share) some times a second; False cancels.
    """
    owned = _check.instance(model, Model, "model")
    with owned.robot._in_its_words():
        found = _pliant.inverse(owned._model, _check.integer(starts, "starts"), _check.progress(progress))
    return InverseResult(owned, found)


class Workspace(NotPickled):
    """The workspace of all markers: equilibria within the ranges of the actuators."""

    __slots__ = ("model", "_space", "_samples")
    _instead = "pickle its arrays, or write its folder"

    def __init__(self, model: Model, space: _pliant.Workspace) -> None:
        self.model = model
        self._space = space
        self._samples = [space.sample(k) for k in range(space.sample_count)]

    @property
    def inputs(self) -> list[SteeredInput]:
        """The inputs that were varied."""
        return [SteeredInput(*i) for i in self._space.inputs()]

    @property
    def values(self) -> Array:
        """(samples, inputs) values of the inputs, SI."""
        return np.array([s[1] for s in self._samples]).reshape(len(self._samples), -1)

    @property
    def found(self) -> npt.NDArray[np.bool_]:
        """(samples,) True where an equilibrium was found."""
        return np.array([s[2] for s in self._samples], dtype=np.bool_)

    @property
    def message(self) -> str:
        """Why no sample has an equilibrium; empty if one has."""
        return self._space.message

    @property
    def warnings(self) -> list[str]:
        """Reasons not to trust a sample, one sentence each."""
        return self._space.warnings

    @property
    def markers(self) -> Array:
        """(samples, markers, 3) m; NaN where no equilibrium was found."""
        return self._filled(3, (len(self.model.markers), 3))

    @property
    def tensions(self) -> Array:
        """(samples, cables) N; NaN where no equilibrium was found."""
        return self._filled(4, (len(self.model.cables),))

    @property
    def pressures(self) -> Array:
        """(samples, chambers) Pa; NaN where no equilibrium was found."""
        return self._filled(5, (len(self.model.chambers),))

    def _filled(self, part: int, shape: tuple[int, ...]) -> Array:
        full = np.full((len(self._samples), *shape), np.nan)
        for k, sample in enumerate(self._samples):
            if sample[2]:
                full[k] = sample[part]
        return full

    def inputs_at(self, index: int) -> Inputs:
        """All inputs of the robot at a sample, for :meth:`Model.step`: its values, and for everything that is not varied
        those at the end of the robot's program."""
        return self.model._inputs_of(self._space.inputs_at(_place(index, len(self), "sample")))

    def sheets(self, marker: str) -> tuple[Array, IntArray]:
        """(points, 3) m and (triangles, 3): the surfaces on which two inputs vary and all others are at an end of their
        range."""
        if not isinstance(marker, str) or marker not in self.model.markers:
            raise InputError(f"there is no marker {marker!r}; there are {', '.join(self.model.markers) or 'none'}")
        return self._space.sheets(self.model.markers.index(marker))

    @property
    def summary(self) -> dict[str, Any]:
        """Number of samples and bounding box of each marker, as in workspace.json."""
        found: dict[str, Any] = json.loads(self._space.json())
        return found

    def write(self, folder: PathLike, *, progress: Progress | None = None) -> None:
        """Writes the folder that ``pliant workspace -o`` writes, whole or not at all."""
        self._space.write(_check.path_text(folder, "folder"), _check.progress(progress))

    def remove_checkpoint(self) -> None:
        """Deletes the checkpoint of the search, if it has one."""
        self._space.remove_checkpoint()

    def __len__(self) -> int:
        return len(self._samples)

    def __repr__(self) -> str:
        return f"<pliant.Workspace of {self.model.robot.name!r}: {len(self)} samples>"


def workspace(
    model: Model,
    *,
    side: int = 9,
    between: int = 100,
    checkpoint: PathLike | None = None,
    resume: bool = False,
    progress: Progress | None = None,
) -> Workspace:
    """Solves for equilibria on sheets of the input ranges and at further samples between them.

    Args:
        model: a model of a robot with a range for each actuator that may be moved.
        side: samples along each input of a sheet; at least 2.
        between: number of further samples, spread over the ranges; none with one input.
        checkpoint: folder in which completed pieces are stored, so that the search can be resumed. What is there of
            the same search, unfinished, is not replaced: resume it, or remove the folder.
        resume: resumes from the checkpoint; the results are those of an uninterrupted search.
        progress: called with (stage, share) some times a second; False cancels.
    """
    owned = _check.instance(model, Model, "model")
    with owned.robot._in_its_words():
        space = _pliant.workspace(
            owned._model,
            _check.integer(side, "side"),
            _check.integer(between, "between"),
            "" if checkpoint is None else _check.path_text(checkpoint, "checkpoint"),
            bool(resume),
            _check.progress(progress),
        )
    return Workspace(owned, space)
