"""A robot that is meshed and ready, its states, and the steps between them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _check, _pliant
from ._check import Array, IntArray, PathLike, Progress
from ._pliant import StepResult
from .controls import Controls, Drive, Inputs, Rest, drive_of
from .errors import Failure, InputError
from .results import Fields, Observation, observation
from .robot import Mesh, Robot

if TYPE_CHECKING:
    from .linearisation import Gradient, Linearisation
    from .program import OnStep, ProgramResult


class State:
    """Everything about a robot that changes: positions, velocities, multipliers, contact, friction and the memory of
    the solver.

    States come from :meth:`Model.rest` and :meth:`Model.solve`; :meth:`Model.step` changes one in place, and
    :meth:`copy` keeps it. Two states are equal if all their bits are. A step from equal states gives equal states, on
    any number of threads and whatever was solved in between, also from one that was saved, pickled or copied.

    An unpickled state has a model of its own, which is made again from the robot: ``model.state_from(state.bytes())``
    is the same state for a model at hand of the same robot.
    """

    __slots__ = ("model", "_state")
    __hash__ = None  # type: ignore[assignment]

    #: The model that this is a state of.
    model: Model

    def __init__(self, model: Model, state: _pliant.State) -> None:
        self.model = model
        self._state = state

    @property
    def positions(self) -> Array:
        """(nodes, 3) node positions, m. Shares the state's memory and cannot be written; does not change when the state
        is stepped."""
        return self._state.positions()

    @property
    def velocities(self) -> Array:
        """(nodes, 3) node velocities, m/s; all zero in a quasi-static simulation."""
        return self._state.velocities()

    @property
    def displacements(self) -> Array:
        """(nodes, 3) displacements from the rest positions, m."""
        moved: Array = self.positions - self.model.rest_positions
        return moved

    @property
    def inputs(self) -> Inputs:
        """Inputs at which the state is in equilibrium."""
        return self.model._inputs_of(self._state.inputs())

    @property
    def time(self) -> float:
        """Program time; in seconds for a motion in time."""
        return self._state.inputs()[0]

    def observe(self) -> Observation:
        """All measurable quantities, by the names of the robot file."""
        return self.model.observe(self)

    def markers(self) -> Array:
        """(markers, 3) marker positions, m, in the order of :attr:`Model.markers`."""
        found = self.observe().markers
        return np.array([found[name] for name in self.model.markers]).reshape(-1, 3)

    def fields(self) -> Fields:
        """Strains and stresses, one value for each tetrahedron."""
        return self.model.fields(self)

    def copy(self) -> State:
        """An independent copy. It is cheap: memory is shared until one of the two is stepped."""
        return State(self.model, _pliant.State(self._state))

    def bytes(self) -> bytes:
        """The whole state in binary form, for storage: :meth:`Model.state_from` reads it."""
        return self._state.bytes()

    def save(self, file: PathLike) -> None:
        """Writes :meth:`bytes` to a file, whole or not at all; :meth:`Model.load_state` reads it.

        Raises:
            InputError: the path is a folder, or is in a folder that does not exist.
            Failure: the file cannot be written.
        """
        self._state.save(os.fspath(_check.new_file(file, "file")))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, State):
            return NotImplemented
        return self._state.equals(other._state)

    def __copy__(self) -> State:
        return self.copy()

    def __deepcopy__(self, memo: Any) -> State:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        return _state_again, (self.model, self.bytes())

    def __repr__(self) -> str:
        return f"<pliant.State of {self.model.robot.name!r} at {self.time:g}>"


def _state_again(model: Model, data: bytes) -> State:
    return model.state_from(data)


class Model:
    """A meshed robot, ready to be simulated. Immutable; any number of threads may use it at once.

    Args:
        robot: the robot that is simulated.
        mesh: for a robot that says ``mesh={"file": "memory:"}``; otherwise the bodies are meshed, which takes seconds,
            or the file that the robot names is read.
        tolerance: largest residual of a converged step, 1e-10 to 0.1, in place of the robot's ``program.tolerance``: in
            everything that is done with the model.
        iteration_limit: solver iterations for each substep, in place of the robot's ``program.max_iterations``,
            likewise; 0: the limit of the solver.
        progress: called with (stage, share) while bodies are meshed; False cancels.

    Raises:
        Failure: the geometry or the mesh is invalid, or something in the robot does not fit the mesh.
    """

    __slots__ = (
        "robot", "mesh", "cables", "chambers", "markers", "_model", "_engine", "_actuators", "_rest", "_options",
    )  # fmt: skip

    _model: _pliant.Model
    #: The robot.
    robot: Robot
    #: The mesh that was given, or None.
    mesh: Mesh | None
    #: Names of the cables, in the order of inputs.
    cables: tuple[str, ...]
    #: Names of the chambers; in inputs they follow the cables.
    chambers: tuple[str, ...]
    #: Names of the markers, in the order of the robot file.
    markers: tuple[str, ...]

    def __init__(
        self,
        robot: Robot,
        mesh: Mesh | None = None,
        *,
        tolerance: float | None = None,
        iteration_limit: int | None = None,
        progress: Progress | None = None,
    ) -> None:
        self.robot = _check.instance(robot, Robot, "robot")
        self.mesh = None if mesh is None else _check.instance(mesh, Mesh, "mesh")
        self._options = (
            None if tolerance is None else _check.number(tolerance, "tolerance"),
            None if iteration_limit is None else _check.integer(iteration_limit, "iteration_limit"),
        )
        given = _check.progress(progress) if self.mesh is None else self.mesh._mesh()
        with self.robot._in_its_words():
            self._model = _pliant.Model(self.robot._robot, given, *self._options)
        self._engine = _pliant.Engine(self._model)
        self.cables = tuple(self._model.cables)
        self.chambers = tuple(self._model.chambers)
        self.markers = tuple(self._model.markers)
        self._actuators = self.cables + self.chambers
        self._rest: dict[str, Rest] | None = None

    # ---- mesh and names

    @property
    def node_count(self) -> int:
        """Number of nodes of the mesh."""
        return self._model.node_count

    @property
    def tet_count(self) -> int:
        """Number of tetrahedra of the mesh."""
        return self._model.tet_count

    @property
    def order(self) -> int:
        """Order of the elements: 1 for 4 nodes per tetrahedron, 2 for 10."""
        return self._model.order

    @property
    def rest_positions(self) -> Array:
        """(nodes, 3) rest positions, m. Shares the model's memory and cannot be written.

        Nodes of a :class:`Mesh` may have other numbers here: points that no tetrahedron uses are dropped.
        """
        return self._model.rest_positions()

    @property
    def tets(self) -> IntArray:
        """(tets, 4 or 10) node indices, corners first. Shares the model's memory and cannot be written."""
        return self._model.tets()

    @property
    def regions(self) -> IntArray:
        """(tets,) index into :attr:`region_names`. Shares the model's memory and cannot be written."""
        return self._model.regions()

    @property
    def region_names(self) -> list[str]:
        """Names of the bodies, one for each region."""
        return self._model.region_names

    def surface(self) -> IntArray:
        """(triangles, 3) corner nodes of the surface, counter-clockwise seen from outside."""
        return self._model.surface()

    @property
    def actuators(self) -> tuple[str, ...]:
        """Names of the cables, then of the chambers: the order of an array of controls."""
        return self._actuators

    def warnings(self) -> list[str]:
        """Warnings about the robot as described, before any step; one sentence each."""
        return self._model.warnings()

    # ---- states

    def rest(self) -> State:
        """The rest state: undeformed and, for a motion in time, with zero velocity."""
        return State(self, self._engine.rest())

    def state_from(self, data: bytes) -> State:
        """Restores a state from :meth:`State.bytes`, of this model or of another one that differs in numbers only.

        The mesh, also of objects, must be the same, node for node, and so must be names and places of supports, cables,
        chambers, pressure loads, springs and joints, the numbers of corners of obstacles and of torques, and whether
        there is motion in time. Material constants, masses, forces, gravity, targets, stiffness and friction may
        differ: positions, tensions and pressures are then those of the other model, and no equilibrium of this one
        until the next step.

        Raises:
            InputError: the data are damaged, or are a state of a robot or mesh that does not fit.
        """
        if not isinstance(data, (bytes, bytearray, memoryview)):
            raise TypeError(f"data must be bytes, not {type(data).__name__}")
        return State(self, self._engine.state_from(bytes(data)))

    def load_state(self, file: PathLike) -> State:
        """Restores a state from a file written by :meth:`State.save`, as :meth:`state_from` does."""
        return State(self, self._engine.load(_check.path_text(file, "file")))

    # ---- inputs

    def program(self, time: float) -> Inputs:
        """The inputs that the robot's program prescribes at `time`."""
        return self._inputs_of(self._engine.program(_check.number(time, "time")))

    def inputs(self, controls: Controls, state: State | None = None, *, time: float | None = None) -> Inputs:
        """Complete inputs from controls as users write them.

        Args:
            controls:
                a mapping from names to targets, in the words of the robot file:
                ``{"flexor": {"shortening": "4 mm"}, "air": {"pressure": "20 kPa"}}``, with `length`, `length_ratio`,
                `shortening`, `tension` of cables and `volume`, `volume_ratio`, `volume_change`, `pressure`, `gas` of
                chambers; text with a unit, or a number in SI units. Actuators that are not named keep their value.
                Or (cables + chambers,) numbers in SI units, of the kinds of the state: lengths, unless another kind was
                set before. Or :class:`Inputs`. Or None: all keep their values.
            state: the state whose values are kept; None: the rest state.
            time: program time, which drives supports, loads, gravity and obstacles; None: that of the inputs or of the
                state.
        """
        known = (self.rest() if state is None else self._own(state))._state.inputs()
        if isinstance(controls, Inputs):
            if controls.names != self._actuators:
                raise InputError("the inputs are those of another model")
            known = controls._tuple()
        when = known[0] if time is None else _check.number(time, "time")
        if controls is None or isinstance(controls, Inputs):
            return self._inputs_of((when, known[1], known[2]))
        return self._changed((when, known[1], known[2]), controls)

    # ---- steps

    def step(
        self,
        state: State,
        controls: Controls = None,
        *,
        time: float | None = None,
        progress: Progress | None = None,
    ) -> StepResult:
        """Solves for equilibrium at the controls and stores the new state in `state`.

        The inputs are ramped linearly from those of the state, in as many substeps as needed. A motion in time
        (``program.time_step``) is integrated up to `time`, which must be later than the time of the state, in equal
        time steps no longer than ``program.time_step``, or than those of the program where they were made longer to
        divide its duration; at the same time, up to rounding, nothing moves.

        Args:
            state: changed in place; :meth:`State.copy` keeps the state before.
            controls, time: as of :meth:`inputs`.
            progress: called with (stage, share) some times a second; False cancels.

        Returns:
            The result of the step. A step that finds no equilibrium is not an error: `arrived` is False, `reason` says
            why, and the state is as far as the solver got.

        Raises:
            InputError: the state belongs to another model, or a number is not possible.
            Cancelled: by `progress`; the state is as far as the solver got. The same holds for KeyboardInterrupt after
                Ctrl-C.
        """
        own = self._own(state)._state
        if progress is not None:
            _check.progress(progress)
        if type(controls) is np.ndarray and controls.dtype == np.float64 and controls.ndim == 1:
            when = None if time is None else _check.number(time, "time")
            return self._engine.step_values(own, controls, when, progress)
        return self._engine.step(own, self.inputs(controls, state, time=time)._tuple(), progress)

    def solve(
        self,
        controls: Controls = None,
        *,
        state: State | None = None,
        time: float | None = None,
        progress: Progress | None = None,
    ) -> State:
        """A new state: that of a step from `state` (None: rest) to the controls; `state` does not change.

        Raises:
            Failure: no equilibrium was found; the text says why.
        """
        found = self.rest() if state is None else self._own(state).copy()
        result = self.step(found, controls, time=time, progress=progress)
        if not result.arrived:
            raise Failure(result.reason or "no equilibrium was found")
        return found

    # ---- measurable quantities

    def observe(self, state: State) -> Observation:
        """All measurable quantities of a state, by the names of the robot file."""
        return observation(self._engine.observe(self._own(state)._state))

    def fields(self, state: State) -> Fields:
        """Strains and stresses, one value for each tetrahedron."""
        return Fields(**self._engine.fields(self._own(state)._state))

    def contact_forces(self, state: State) -> Array:
        """(nodes, 3) contact force on each node, normal force and friction, N; zero for nodes without contact."""
        return self._engine.contact_forces(self._own(state)._state)

    def cable_paths(self, state: State) -> dict[str, Array]:
        """Path of each cable by its name: (points, 3) m."""
        return dict(zip(self.cables, self._engine.cable_paths(self._own(state)._state)))

    # ---- derivatives

    def linearise(self, state: State) -> Linearisation:
        """First-order response of an equilibrium to small changes; exact derivatives. In a motion in time they are those
        of the last step alone: the state before it is held constant."""
        from .linearisation import Linearisation

        return Linearisation(self._own(state))

    def jacobian(self, state: State, markers: Iterable[str] | None = None) -> Array:
        """(markers, 3, cables + chambers) derivatives of the marker positions with respect to each control, in m per SI
        unit of the control.

        One linear solve for each control, all with one factorisation. The length of a slack cable has no effect: at
        rest the derivative is zero. Start from a slightly pulled cable, at 0.98 of its length for example. In a motion
        in time it is the derivative of the last step alone: see :meth:`grad`.

        Args:
            state: a state returned by a step.
            markers: names; None: all.
        """
        return self.linearise(state).jacobian(markers)

    def grad(
        self,
        state: State,
        *,
        positions: Any = None,
        tensions: Any = None,
        pressures: Any = None,
        markers: Mapping[str, Any] | None = None,
        guide_points: bool = False,
    ) -> Gradient:
        """Exact derivatives of a function of the state, by one transposed solve.

        The function is given by its own derivatives with respect to positions (nodes, 3), tensions (cables,), pressures
        (chambers,) and the positions of markers, ``{"tip": [0, 0, 1]}``; those left out are zero. With `guide_points`
        it is also differentiated with respect to the guide points of cables and springs.

        In a motion in time these are derivatives of the last step alone: the state before it is held constant, also
        where a parameter acted on it. :func:`pliant.gradient` differentiates the whole motion.

        Lagged quantities are held constant: see :func:`pliant.gradient`. The derivative with respect to the length of a
        slack cable is zero: see :meth:`jacobian`.

        Returns:
            Derivatives with respect to controls, inputs, parameters (materials, loads, friction...) and rest positions.
        """
        return self.linearise(state).gradient(
            positions=positions, tensions=tensions, pressures=pressures, markers=markers, guide_points=guide_points
        )

    # ---- the program of the robot

    def run(
        self,
        on_step: OnStep | None = None,
        *,
        measured: PathLike | None = None,
        checkpoint: PathLike | None = None,
        checkpoint_every: int = 0,
        resume: bool = False,
        progress: Progress | None = None,
    ) -> ProgramResult:
        """Runs the robot's program from rest to its end: what ``pliant simulate`` does, to the last bit.

        A program that stops early, or is cancelled by `progress`, is not an error: the result says so and has the steps
        up to then.

        Args:
            on_step: called with each :class:`ProgramStep` as soon as it is solved, the rest state first.
            measured: CSV of measured marker positions, for comparison with the simulated ones.
            checkpoint: folder in which the run is saved as it proceeds, so that it can be resumed. What is there of
                the same run, unfinished, is not replaced: resume it, or remove the folder.
            checkpoint_every: steps between checkpoints; 0: after each step, or with `resume` as in the checkpoint.
            resume: resumes from the checkpoint.
            progress: called with (stage, share) some times a second; False cancels.
        """
        from .program import run

        return run(self, on_step, measured, checkpoint, checkpoint_every, resume, progress)

    # ---- internal

    def _own(self, state: State) -> State:
        if not isinstance(state, State):
            _check.instance(state, State, "state")
        if state.model is not self and state.model._model is not self._model:
            raise InputError("the state is one of another model")
        return state

    def _changed(self, known: tuple[float, Any, Any], controls: Any) -> Inputs:
        """The known inputs, replaced where a mapping or an array of numbers says so."""
        if not isinstance(controls, Mapping):
            values = _check.numbers(controls, "controls", (len(self._actuators),))
            return self._inputs_of((known[0], known[1], values.tolist()))
        by, numbers = list(known[1]), list(known[2])
        rest = self._rest_measures()
        for name, wanted in controls.items():
            if not isinstance(name, str) or name not in rest:
                raise InputError(self._no_actuator(name), key=str(name))
            index = self._actuators.index(name)
            by[index], numbers[index] = drive_of(name, rest[name], wanted)
        return self._inputs_of((known[0], by, numbers))

    def _inputs_of(self, known: tuple[float, Any, Any]) -> Inputs:
        return Inputs._known(self._actuators, *known)

    def _rest_measures(self) -> dict[str, Rest]:
        if self._rest is None:
            seen = self._engine.observe(self._engine.rest())
            self._rest = {
                **{name: Rest(True, seen["cables"][name][0]) for name in self.cables},
                **{name: Rest(False, seen["chambers"][name][0]) for name in self.chambers},
            }
        return self._rest

    def _no_actuator(self, name: Any) -> str:
        if not self._actuators:
            return f"there is no cable or chamber {name!r}; the robot has none"
        return f"there is no cable or chamber {name!r}; there are {', '.join(self._actuators)}"

    def __reduce__(self) -> tuple[Any, ...]:
        return _model_again, (self.robot, self.mesh, *self._options)

    def __copy__(self) -> Model:
        return self

    def __deepcopy__(self, memo: Any) -> Model:
        return self

    def __repr__(self) -> str:
        return f"<pliant.Model {self.robot.name!r}: {self.node_count} nodes, {self.tet_count} tets>"


def _model_again(robot: Robot, mesh: Mesh | None, tolerance: float | None, iteration_limit: int | None) -> Model:
    return Model(robot, mesh, tolerance=tolerance, iteration_limit=iteration_limit)
