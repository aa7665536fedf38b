"""Runs the program of a robot from rest to its end."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Union, overload

import numpy as np

from . import _check, _pliant
from ._check import Array, PathLike, Progress
from ._pliant import StepResult
from ._values import NotPickled, Value
from .errors import InputError, arguments_for_options
from .results import Observation, observation

if TYPE_CHECKING:
    from .model import Model


@dataclass(frozen=True, eq=False)
class ProgramStep(Value):
    """A step of a program."""

    #: 0: the rest state
    index: int
    #: program time
    time: float
    #: result of the solver
    result: StepResult
    #: measurable quantities of the state
    observed: Observation
    #: (nodes, 3) m
    positions: Array


OnStep = Callable[[ProgramStep], Any]

_ARGUMENTS = {
    "a run makes one where it is told to keep checkpoints": "run(checkpoint=FOLDER) makes one",
}


class ProgramResult(NotPickled):
    """Result of a program: a sequence of :class:`ProgramStep`, the rest state first. A slice is a list of them."""

    __slots__ = ("model", "_result")
    _instead = "pickle its steps, as list(result), or write its folder"

    def __init__(self, model: Model, result: _pliant.ProgramResult) -> None:
        self.model = model
        self._result = result

    @property
    def converged(self) -> bool:
        """True if the program ran to its end."""
        return self._result.converged

    @property
    def message(self) -> str:
        """Where and why the program stopped early; otherwise empty."""
        return self._result.message

    @property
    def warnings(self) -> list[str]:
        """Reasons not to trust the result, one sentence each."""
        return self._result.warnings

    @property
    def solver(self) -> str:
        """Name of the solver that was requested or chosen."""
        return self._result.solver

    @property
    def solve_s(self) -> float:
        """Wall time of solving, s."""
        return self._result.solve_s

    @property
    def summary(self) -> dict[str, Any]:
        """All figures, as in summary.json."""
        found: dict[str, Any] = json.loads(self._result.summary_json())
        return found

    @property
    def positions(self) -> Array:
        """(steps, nodes, 3) m, of all steps."""
        return np.stack([self._result.positions(k) for k in range(len(self))])

    @property
    def times(self) -> Array:
        """(steps,) program time of each step."""
        return np.array([self._result.step(k)[1] for k in range(len(self))])

    @property
    def markers(self) -> dict[str, Array]:
        """Path of each marker by its name: (steps, 3) m."""
        seen = [self._result.step(k)[3]["markers"] for k in range(len(self))]
        return {name: np.array([s[name] for s in seen]) for name in self.model.markers}

    def deviations(self) -> list[str]:
        """One line per measured marker: the distance of the measured points from the simulated path."""
        return self._result.deviations()

    def write(
        self,
        folder: PathLike,
        *,
        pictures: str = "few",
        picture_size_px: tuple[int, int] | None = None,
        film: bool = False,
        view: Any = None,
        progress: Progress | None = None,
    ) -> None:
        """Writes the folder that ``pliant simulate -o`` writes, whole or not at all, in place of an older one.

        Args:
            folder: its path.
            pictures: "none", "few" or "all".
            picture_size_px: width and height.
            film: also film.gif, the motion as an animated GIF.
            view: (3,) direction from the robot to the camera; None: where the motion shows best.
            progress: called with (stage, share) some times a second; False cancels.
        """
        _check.one_of(pictures, ("none", "few", "all"), "pictures")
        size = _check.integers((0, 0) if picture_size_px is None else picture_size_px, "picture_size_px")
        if size.shape != (2,):
            raise InputError("picture_size_px must be (width, height)")
        eye = None if view is None else _check.numbers(view, "view", (3,)).tolist()
        place = _check.path_text(folder, "folder")
        self._result.write(place, pictures, size.tolist(), bool(film), eye, _check.progress(progress))

    def remove_checkpoint(self) -> None:
        """Deletes the checkpoint of the run, if it has one."""
        self._result.remove_checkpoint()

    def __len__(self) -> int:
        return self._result.step_count

    @overload
    def __getitem__(self, index: int) -> ProgramStep: ...
    @overload
    def __getitem__(self, index: slice) -> list[ProgramStep]: ...

    def __getitem__(self, index: Union[int, slice]) -> Union[ProgramStep, list[ProgramStep]]:
        if isinstance(index, slice):
            return [self[k] for k in range(len(self))[index]]
        wanted = _check.integer(index, "index")
        wanted += len(self) if wanted < 0 else 0
        if not 0 <= wanted < len(self):
            raise IndexError(f"there is no step {index}; the last is {len(self) - 1}")
        return _step(self._result.step(wanted))

    def __iter__(self) -> Iterator[ProgramStep]:
        return (self[k] for k in range(len(self)))

    def __repr__(self) -> str:
        end = "" if self.converged else f", {self.message}"
        return f"<pliant.ProgramResult of {self.model.robot.name!r}: {len(self)} steps{end}>"


def run(
    model: Model,
    on_step: OnStep | None,
    measured: PathLike | None,
    checkpoint: PathLike | None,
    checkpoint_every: int,
    resume: bool,
    progress: Progress | None,
) -> ProgramResult:
    """As :meth:`Model.run`."""
    if on_step is not None and not callable(on_step):
        raise TypeError(f"on_step must be callable, not {type(on_step).__name__}")
    heard = None if on_step is None else lambda step: on_step(_step(step))
    with arguments_for_options(_ARGUMENTS), model.robot._in_its_words():
        result = _pliant.run(
            model._model,
            heard,
            "" if measured is None else _check.path_text(measured, "measured"),
            "" if checkpoint is None else _check.path_text(checkpoint, "checkpoint"),
            _check.integer(checkpoint_every, "checkpoint_every"),
            bool(resume),
            _check.progress(progress),
        )
    return ProgramResult(model, result)


def _step(step: tuple[int, float, StepResult, dict[str, Any], Array]) -> ProgramStep:
    index, time, result, seen, positions = step
    return ProgramStep(index, time, result, observation(seen), positions)
