"""Many robots, or many states of one robot, in parallel: one core for each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Union

from . import _check, _pliant
from ._check import Progress
from ._pliant import StepResult
from ._values import NotPickled
from .controls import Controls
from .errors import InputError
from .model import Model, State
from .results import Observation, observation

#: Of a batch: each has a solver of its own.
MOST_ROBOTS = 100_000


class Batch(NotPickled):
    """Steps many robots in parallel, on all cores and without the interpreter's lock.

    The results have the same bits as those of :meth:`Model.step` for one robot after the other, on any number of
    threads::

        batch = pliant.Batch(model, 64)
        states = batch.rest()
        results = batch.step(states, lengths)            # (64, cables + chambers)

    Args:
        models: a model for each robot, or one model for all.
        count: number of robots, if one model is given for all.
        threads: number of threads; 0: one for each core.
        tolerance, iteration_limit: replace those of the models, as for :class:`Model`; None: those of the models.
    """

    __slots__ = ("models", "_batch")
    _instead = "pickle its states, and make it again"

    #: (robots) the model of each
    models: tuple[Model, ...]

    def __init__(
        self,
        models: Union[Model, Iterable[Model]],
        count: int | None = None,
        *,
        threads: int = 0,
        tolerance: float | None = None,
        iteration_limit: int | None = None,
    ) -> None:
        if isinstance(models, Model):
            robots = 1 if count is None else _check.integer(count, "count")
            if not 0 <= robots <= MOST_ROBOTS:
                raise InputError(f"count is {robots}; a batch has 0 to {MOST_ROBOTS:,} robots")
            self.models = (models,) * robots
        elif not isinstance(models, Iterable):
            raise TypeError(f"models must be a pliant.Model or several, not {type(models).__name__}")
        else:
            if count is not None:
                raise InputError("count goes with one model; there are as many robots as models")
            self.models = tuple(_check.instance(m, Model, "each of models") for m in models)
        self._batch = _pliant.Batch(
            [m._model for m in self.models],
            None if tolerance is None else _check.number(tolerance, "tolerance"),
            None if iteration_limit is None else _check.integer(iteration_limit, "iteration_limit"),
            _check.integer(threads, "threads"),
        )

    @property
    def threads(self) -> int:
        """Number of threads used."""
        return self._batch.threads

    def rest(self) -> list[State]:
        """(robots) rest states."""
        return [model.rest() for model in self.models]

    def step(
        self,
        states: Iterable[State],
        controls: Any = None,
        *,
        time: float | None = None,
        progress: Progress | None = None,
    ) -> list[StepResult]:
        """Steps each robot, as :meth:`Model.step`.

        Args:
            states: (robots) changed in place.
            controls: for each robot what :meth:`Model.inputs` takes; may be an array (robots, cables + chambers). None:
                all keep their values.
            time: program time for all; None: that of each state.
            progress: called with ("robots", share) some times a second; False cancels.

        Raises:
            InputError: the message names the robot; all states are unchanged.
            Cancelled: by `progress`; each state is as far as its solver got. The same holds for KeyboardInterrupt after
                Ctrl-C.
        """
        listed = self._listed(states)
        own = self._own(listed)
        wanted: Sequence[Controls] = [None] * len(own) if controls is None else _controls(controls, len(own))
        tuples = []
        for k, (model, state, control) in enumerate(zip(self.models, listed, wanted)):
            try:
                tuples.append(model.inputs(control, state, time=time)._tuple())
            except InputError as error:
                raise InputError(f"robot {k}: {error}", key=error.key) from None
        return self._batch.step(own, tuples, _check.progress(progress))

    def observe(self, states: Iterable[State]) -> list[Observation]:
        """(robots) measurable quantities of each state."""
        return [observation(seen) for seen in self._batch.observe(self._own(self._listed(states)))]

    def _listed(self, states: Iterable[State]) -> list[State]:
        listed = _check.several(states, State, "states")
        if len(listed) != len(self.models):
            raise InputError(f"{len(listed)} states for {len(self.models)} robots")
        if len({id(s) for s in listed}) != len(listed):
            raise InputError("the same state is given for two robots; State.copy makes another")
        return listed

    def _own(self, listed: list[State]) -> list[_pliant.State]:
        own = []
        for k, (model, state) in enumerate(zip(self.models, listed)):
            try:
                own.append(model._own(state)._state)
            except InputError as error:
                raise InputError(f"robot {k}: {error}") from None
        return own

    def __len__(self) -> int:
        return len(self.models)

    def __repr__(self) -> str:
        return f"<pliant.Batch of {len(self)} robots, {self.threads} threads>"


def _controls(controls: Any, robots: int) -> Sequence[Controls]:
    if isinstance(controls, Mapping) or not _check.is_several(controls):
        raise InputError(f"controls must be a list with one entry for each of {robots} robots")
    listed = list(controls)
    if len(listed) != robots:
        raise InputError(f"{len(listed)} controls for {robots} robots")
    return listed
