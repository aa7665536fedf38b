"""Inverse kinematics and workspaces: what to pull so that the robot gets there, and where it can get."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from . import _check, _pliant
from ._check import Array, IntArray, PathLike, Progress
from ._pliant import StepResult
from .errors import InputError
from .model import Model
from .results import Observation, observation


class SteeredInput(NamedTuple):
    """An actuator with a range: what :func:`inverse` and :func:`workspace` may move."""

    #: of the cable or chamber
    name: str
    #: SI, of what its target names; "" of a ratio
    unit: str
    #: of its range
    low: float
    #: of its range
    high: float


class GoalResult(NamedTuple):
    """How one goal fares at a waypoint."""

    #: as in the robot file
    name: str
    #: within its tolerance
    reached: bool
    #: m, rad or N, as `unit` says; of several markers the largest
    error: float
    #: of the error
    unit: str
    #: (n, 3) places; of a plane a point and its normal; a unit direction; a force
    wanted: Array
    #: (n, 3) places of its markers; a direction; a force
    got: Array


@dataclass(frozen=True)
class Waypoint:
    """A waypoint, as far as the robot got to it."""

    #: all of its goals
    reached: bool
    #: of the robot's program: where all that is not steered stands
    time: float
    #: in the order of the robot file
    goals: list[GoalResult]
    #: by name, SI, in what the target names
    inputs: dict[str, float]
    #: where not reached: what stops it, a sentence each
    limits: list[str]
    #: of the equilibrium
    result: StepResult
    #: what it is like
    observed: Observation
    #: (nodes, 3) m
    positions: Array
    #: equilibria that were solved for on the way
    forward_solutions: int
    #: wall time of the search
    wall_s: float


class InverseResult:
    """What came of the goals: a sequence of :class:`Waypoint`."""

    __slots__ = ("model", "_result")

    def __init__(self, model: Model, result: _pliant.InverseResult) -> None:
        self.model = model
        self._result = result

    @property
    def reached(self) -> bool:
        """All waypoints."""
        return self._result.reached

    @property
    def message(self) -> str:
        """Why waypoints are missing; empty where none is."""
        return self._result.message

    @property
    def notes(self) -> list[str]:
        """What is worth knowing about the search, a sentence each."""
        return self._result.notes

    @property
    def inputs(self) -> list[SteeredInput]:
        """What was moved."""
        return [SteeredInput(*i) for i in self._result.inputs()]

    @property
    def waypoints_wanted(self) -> int:
        """Waypoints of the goals."""
        return self._result.waypoints_wanted

    @property
    def text(self) -> str:
        """For people: a line for each waypoint, and what stops those that are not reached."""
        return self._result.text()

    @property
    def summary(self) -> dict[str, Any]:
        """All figures, as in inverse.json."""
        found: dict[str, Any] = json.loads(self._result.json())
        return found

    def write(self, folder: PathLike, *, progress: Progress | None = None) -> list[str]:
        """Writes the folder that ``pliant inverse -o`` writes, whole or not at all.

        Returns:
            Warnings where the program that leads through the waypoints, run from rest, leads elsewhere.
        """
        return self._result.write(_check.path(folder, "folder"), _check.progress(progress))

    def __len__(self) -> int:
        return self._result.waypoint_count

    def __getitem__(self, index: int) -> Waypoint:
        wanted = _check.integer(index, "index")
        wanted += len(self) if wanted < 0 else 0
        if not 0 <= wanted < len(self):
            raise IndexError(f"there is no waypoint {index}; there are {len(self)}")
        reached, time, goals, inputs, limits, result, seen, positions, solutions, wall_s = self._result.waypoint(wanted)
        named = dict(zip((i.name for i in self.inputs), inputs))
        listed = [GoalResult(*g) for g in goals]
        return Waypoint(
            reached, time, listed, named, limits, result, observation(seen), positions, solutions, wall_s
        )

    def __iter__(self) -> Iterator[Waypoint]:
        return (self[k] for k in range(len(self)))

    def __repr__(self) -> str:
        reached = sum(w.reached for w in self)
        return f"<pliant.InverseResult of {self.model.robot.name!r}: {reached} of {self.waypoints_wanted} reached>"


def inverse(model: Model, *, starts: int = 6, progress: Progress | None = None) -> InverseResult:
    """Looks for the inputs that take the robot to the goals of its file, waypoint by waypoint; every answer is an
    equilibrium. What cannot be reached ends as near as it gets, and is no error.

    Args:
        model: of a robot with goals and with a range on what may be moved.
        starts: beginnings spread over the ranges that are tried where the way from rest does not reach the first
            waypoint.
        progress: called with (stage, share) some times a second; False cancels.
    """
    owned = _check.instance(model, Model, "model")
    return InverseResult(
        owned, _pliant.inverse(owned._model, _check.integer(starts, "starts"), _check.progress(progress))
    )


class Workspace:
    """Where markers can get within the ranges of the actuators, and what that takes."""

    __slots__ = ("model", "_space", "_samples")

    def __init__(self, model: Model, space: _pliant.Workspace) -> None:
        self.model = model
        self._space = space
        self._samples = [space.sample(k) for k in range(space.sample_count)]

    @property
    def inputs(self) -> list[SteeredInput]:
        """What was moved."""
        return [SteeredInput(*i) for i in self._space.inputs()]

    @property
    def values(self) -> Array:
        """(samples, inputs) SI, where equilibria were looked for."""
        return np.array([s[1] for s in self._samples]).reshape(len(self._samples), -1)

    @property
    def found(self) -> Array:
        """(samples,) 1 where there is an equilibrium, else 0."""
        return np.array([float(s[2]) for s in self._samples])

    @property
    def markers(self) -> Array:
        """(samples, markers, 3) m; not a number where no equilibrium was found."""
        return self._filled(3, (len(self.model.markers), 3))

    @property
    def tensions(self) -> Array:
        """(samples, cables) N; not a number where no equilibrium was found."""
        return self._filled(4, (len(self.model.cables),))

    @property
    def pressures(self) -> Array:
        """(samples, chambers) Pa; not a number where no equilibrium was found."""
        return self._filled(5, (len(self.model.chambers),))

    def _filled(self, part: int, shape: tuple[int, ...]) -> Array:
        full = np.full((len(self._samples), *shape), np.nan)
        for k, sample in enumerate(self._samples):
            if sample[2]:
                full[k] = sample[part]
        return full

    def sheets(self, marker: str) -> tuple[Array, IntArray]:
        """(points, 3) m and (triangles, 3): the surfaces on which two inputs vary and all others stand at an end."""
        if not isinstance(marker, str) or marker not in self.model.markers:
            raise InputError(f"there is no marker {marker!r}; there are {', '.join(self.model.markers) or 'none'}")
        return self._space.sheets(self.model.markers.index(marker))

    @property
    def summary(self) -> dict[str, Any]:
        """Number of samples and box of each marker, as in workspace.json."""
        found: dict[str, Any] = json.loads(self._space.json())
        return found

    def write(self, folder: PathLike, *, progress: Progress | None = None) -> None:
        """Writes the folder that ``pliant workspace -o`` writes, whole or not at all."""
        self._space.write(_check.path(folder, "folder"), _check.progress(progress))

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
    """Solves for equilibria on sheets of the ranges and in between.

    Args:
        model: of a robot with a range on what may be moved.
        side: places along each input of a sheet; at least 2.
        between: inputs that are spread over the ranges beside the sheets.
        checkpoint: folder in which pieces are kept as they are done.
        resume: goes on from the checkpoint; the results are those of a search that was never stopped.
        progress: called with (stage, share) some times a second; False cancels.
    """
    owned = _check.instance(model, Model, "model")
    return Workspace(
        owned,
        _pliant.workspace(
            owned._model,
            _check.integer(side, "side"),
            _check.integer(between, "between"),
            "" if checkpoint is None else _check.path(checkpoint, "checkpoint"),
            bool(resume),
            _check.progress(progress),
        ),
    )
