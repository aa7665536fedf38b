"""Reduced-order models: a robot with a few modes instead of thousands of nodes, for control loops and policies."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

from . import _check, _pliant
from ._check import Array, PathLike, Progress
from ._values import value_tuple
from .controls import Controls, Inputs
from .errors import Failure, InputError
from .model import Model, State
from .steering import SteeredInput


class ReducedStep(NamedTuple):
    """Result of a step of a reduced model."""

    #: True if the state is the equilibrium at the controls; otherwise it is unchanged
    found: bool
    #: number of iterations of Newton's method
    iterations: int


class ReducedError(NamedTuple):
    """Estimated difference between a reduced state and the equilibrium of the whole robot at the same inputs."""

    #: m, the largest of any node; infinite if the whole robot cannot be there
    error: float
    #: by name, m
    markers: dict[str, float]
    #: by name, N
    tensions: dict[str, float]
    #: by name, Pa
    pressures: dict[str, float]


@value_tuple
class ReducedCheck(NamedTuple):
    """A reduced model beside the whole robot, at inputs that it was not made from."""

    #: (inputs,) SI, in the order of :attr:`ReducedModel.inputs`
    inputs: Array
    #: True if both have an equilibrium; otherwise the following values are unknown
    found: bool
    #: True if the whole robot touches itself there; the reduced model has no contact
    touching: bool
    #: m, largest motion of a node of the whole robot, from rest
    motion: float
    #: m, largest difference of a node
    error: float
    #: m, the estimate of that
    estimated: float
    #: largest of tensions and pressures, relative to the largest of the samples
    force_error: float
    #: s, wall time of the reduced step, from the inputs before
    reduced_s: float
    #: s, of the estimate
    estimate_s: float
    #: s, of the step of the whole robot
    whole_s: float


class ReducedState:
    """An equilibrium of a reduced model. :meth:`ReducedModel.step` changes one in place, :meth:`copy` keeps it."""

    __slots__ = ("reduced", "_state")

    #: The reduced model that this is a state of.
    reduced: ReducedModel

    def __init__(self, reduced: ReducedModel, state: _pliant.ReducedState) -> None:
        self.reduced = reduced
        self._state = state

    @property
    def inputs(self) -> Inputs:
        """Inputs at which the state is in equilibrium."""
        return self.reduced.model._inputs_of(self._state.inputs())

    @property
    def amplitudes(self) -> Array:
        """(modes,) amplitude of each mode, m."""
        return self._state.amplitudes()

    @property
    def markers(self) -> Array:
        """(markers, 3) m, in the order of :attr:`Model.markers`."""
        found: Array = self._state.markers().reshape(-1, 3)
        return found

    @property
    def tensions(self) -> Array:
        """(cables,) tensions, N."""
        return self._state.tensions()

    @property
    def pressures(self) -> Array:
        """(chambers,) pressures above ambient, Pa."""
        return self._state.pressures()

    @property
    def positions(self) -> Array:
        """(nodes, 3) positions of all nodes of the whole robot, m."""
        return self._state.positions()

    def copy(self) -> ReducedState:
        """An independent copy."""
        return ReducedState(self.reduced, self._state)

    def __copy__(self) -> ReducedState:
        return self.copy()

    def __deepcopy__(self, memo: Any) -> ReducedState:
        return self.copy()

    def __reduce__(self) -> Any:
        raise TypeError("a ReducedState cannot be pickled; pickle its inputs, or the state that exact() gives")

    def __repr__(self) -> str:
        return f"<pliant.ReducedState of {self.reduced.model.robot.name!r}>"


class ReducedModel:
    """A robot with a few modes: see :func:`reduce`. May be used by several threads, one at a time."""

    __slots__ = ("model", "_engine")

    #: The whole robot.
    model: Model

    def __init__(self, model: Model, engine: _pliant.ReducedEngine) -> None:
        self.model = model
        self._engine = engine

    @classmethod
    def load(cls, model: Model, file: PathLike) -> ReducedModel:
        """Reads a file written by :meth:`save` or ``pliant reduce -o``.

        Raises:
            InputError: the file is damaged, or was made for another robot or with other settings, such as another
                tolerance of the model.
        """
        owned = _check.instance(model, Model, "model")
        return cls(owned, _pliant.load_reduced(owned._model, _check.path_text(file, "file")))

    def save(self, file: PathLike) -> None:
        """Writes the reduced model to a file whose name ends in .reduced, whole or not at all."""
        found = _check.new_file(file, "file")
        if found.suffix != ".reduced":
            better = found.with_suffix(".reduced").name
            raise InputError(f"{found}: the file of a reduced model ends in .reduced, as in {better}", file=str(found))
        self._engine.save(os.fspath(found))

    @property
    def inputs(self) -> list[SteeredInput]:
        """The actuators whose ranges the samples cover."""
        return [SteeredInput(*i) for i in self._engine.inputs()]

    @property
    def mode_count(self) -> int:
        """Number of modes."""
        return self._engine.mode_count

    @property
    def tet_count(self) -> int:
        """Number of tetrahedra that are evaluated."""
        return self._engine.tet_count

    @property
    def sample_count(self) -> int:
        """Number of equilibria that it was made from."""
        return self._engine.sample_count

    @property
    def force_error(self) -> float:
        """Share of the forces of the samples that the weighted tetrahedra miss."""
        return self._engine.force_error

    @property
    def notes(self) -> list[str]:
        """Remarks on how it was made, one sentence each."""
        return self._engine.notes

    def start(self) -> ReducedState:
        """A state to begin with: without actuation if that has an equilibrium."""
        return ReducedState(self, self._engine.start())

    def step(self, state: ReducedState, controls: Controls = None, *, time: float | None = None) -> ReducedStep:
        """Solves for the equilibrium at the controls, from `state`, and stores it there.

        Args:
            state: changed in place if an equilibrium is found.
            controls: as for :meth:`Model.inputs`; an array of numbers in SI units is fastest.
            time: program time; None: that of the state.
        """
        own = self._own(state)
        known = own._state.inputs()
        if isinstance(controls, Inputs):
            known = self.model.inputs(controls)._tuple()
        elif controls is not None:
            known = self.model._changed(known, controls)._tuple()
        when = known[0] if time is None else _check.number(time, "time")
        own._state, found, iterations = self._engine.step(own._state, (when, known[1], known[2]))
        return ReducedStep(found, iterations)

    def solve(self, controls: Controls = None, *, state: ReducedState | None = None) -> ReducedState:
        """A new state: the equilibrium at the controls; `state` (None: :meth:`start`) does not change.

        Raises:
            Failure: no equilibrium was found.
        """
        found = self.start() if state is None else self._own(state).copy()
        if not self.step(found, controls).found:
            raise Failure("the reduced model has no equilibrium at these controls")
        return found

    def estimate(self, state: ReducedState) -> ReducedError:
        """Estimates the error by one step of Newton's method on the whole robot, with a factor that is kept."""
        error, markers, tensions, pressures = self._engine.estimate(self._own(state)._state)
        model = self.model
        return ReducedError(
            error,
            dict(zip(model.markers, markers.tolist())),
            dict(zip(model.cables, tensions.tolist())),
            dict(zip(model.chambers, pressures.tolist())),
        )

    def exact(self, state: ReducedState, *, progress: Progress | None = None) -> State:
        """The equilibrium of the whole robot at the same inputs, searched from the reduced one.

        Raises:
            Failure: no equilibrium is found.
        """
        return State(self.model, self._engine.exact(self._own(state)._state, _check.progress(progress)))

    def check(self, count: int = 10, *, progress: Progress | None = None) -> list[ReducedCheck]:
        """Compares it with the whole robot at `count` other inputs, spread over the ranges."""
        rows = self._engine.check(_check.integer(count, "count"), _check.progress(progress))
        return [ReducedCheck(*row) for row in rows]

    def _bytes(self) -> bytes:
        """Those of the file that :meth:`save` writes."""
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "reduced"
            self._engine.save(os.fspath(file))
            return file.read_bytes()

    def __reduce__(self) -> tuple[Any, ...]:
        return _reduced_again, (self.model, self._bytes())

    def __copy__(self) -> ReducedModel:
        return self

    def __deepcopy__(self, memo: Any) -> ReducedModel:
        return self

    def _own(self, state: ReducedState) -> ReducedState:
        if _check.instance(state, ReducedState, "state").reduced._engine is not self._engine:
            raise InputError("the state is one of another reduced model")
        return state

    def __repr__(self) -> str:
        return f"<pliant.ReducedModel of {self.model.robot.name!r}: {self.mode_count} modes, {self.tet_count} tets>"


def _reduced_again(model: Model, data: bytes) -> ReducedModel:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "reduced"
        file.write_bytes(data)
        return ReducedModel.load(model, file)


def reduce(
    model: Model,
    *,
    samples: int = 0,
    basis_error: float = 1e-4,
    force_error: float = 1e-4,
    most_modes: int = 60,
    progress: Progress | None = None,
) -> ReducedModel:
    """Makes a reduced model: solves for equilibria of the whole robot within the ranges of its actuators, finds the
    modes of which they are made, and a few tetrahedra whose weighted forces stand for all.

    Args:
        model: a model of a robot with a range for each actuator that may be moved; without contact, friction, moving
            supports, joints and motion in time.
        samples: equilibria to learn from; 0: 24 for each actuator, 240 at most. That without actuation and, with up
            to four actuators, the corners of the ranges are always among them.
        basis_error: share of the motion of the samples that the modes may leave out.
        force_error: share of the forces in the modes that the weighted tetrahedra may miss.
        most_modes: largest number of modes.
        progress: called with (stage, share) some times a second; False cancels.
    """
    owned = _check.instance(model, Model, "model")
    with owned.robot._in_its_words():
        engine = _pliant.reduce(
            owned._model,
            _check.integer(samples, "samples"),
            _check.number(basis_error, "basis_error"),
            _check.number(force_error, "force_error"),
            _check.integer(most_modes, "most_modes"),
            _check.progress(progress),
        )
    return ReducedModel(owned, engine)
