"""Base of all environments: the signatures of Gymnasium 0.29, seeds, states that can be saved and restored."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, ClassVar, NamedTuple

import numpy as np
import numpy.typing as npt

from .. import _check
from .._pliant import StepResult
from .._values import Value
from ..controls import Inputs
from ..errors import InputError
from ..model import Model, State
from ..results import Observation
from .spaces import box

try:
    from gymnasium import Env as _Base
except ImportError:
    _Base = object


FloatArray = npt.NDArray[np.float32]


@dataclass(eq=False)
class Episode(Value):
    """The complete state of an environment: a value that can be copied, compared, pickled and restored."""

    #: state of the robot
    robot: State
    #: (actuators,) position of each in its range, 0 to 1
    pulled: npt.NDArray[np.float64]
    #: number of steps since the reset
    steps: int = 0
    #: variables of the task, by name
    task: dict[str, Any] = field(default_factory=dict)
    #: state of the random generator of resets
    random: dict[str, Any] = field(default_factory=dict)
    #: name of the class of the environment
    kind: str = ""


class Half(NamedTuple):
    """First half of a step, before the robot is solved."""

    #: (actuators,) from -1 to 1
    action: FloatArray
    #: (actuators,) position of each in its range after the step
    pulled: npt.NDArray[np.float64]
    inputs: Inputs
    #: a copy of the robot's state, to be stepped
    robot: State


class RobotEnv(_Base):  # type: ignore[misc]
    """A robot with a task; actions move its actuators.

    An action is the change of each actuator in this step: -1 and 1 are the largest changes, towards the first and the
    second end of its range. Every step is an equilibrium of the whole robot, or a step in time. The same seed and
    the same actions give the same numbers to the last bit, on any number of threads, alone or in a
    :class:`~pliant.envs.Vector`.

    A step that finds no equilibrium ends the episode: `terminated` is True and ``info["failed"]`` says why.

    Unlike Gymnasium's own environments, these can be saved and restored: :meth:`get_state` and :meth:`set_state`.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 10}
    render_mode: str | None = None
    spec: Any = None

    #: Steps until an episode is truncated.
    max_steps: ClassVar[int] = 25
    #: Largest change of an actuator in a step, as a share of its range.
    largest_change: ClassVar[float] = 0.15
    #: Names of the options of reset; None: any.
    option_names: ClassVar[tuple[str, ...] | None] = None
    #: Shape of each variable that `episode.task` must have, by its name.
    task_shapes: ClassVar[Mapping[str, tuple[int, ...]]] = {}

    def __init__(self, model: Model | None = None, *, render_mode: str | None = None) -> None:
        if render_mode not in (None, "rgb_array"):
            raise InputError(f'render_mode is None or "rgb_array", not {render_mode!r}')
        self.render_mode = render_mode
        self.model = self.make_model() if model is None else _check.instance(model, Model, "model")
        self.check_model()
        self._low, self._high, self._kinds = self.ranges()
        count = len(self._low)
        self.action_space = box(-1.0, 1.0, (count,), np.float32)
        self.observation_space = box(-np.inf, np.inf, (self.observation_size(),), np.float32)
        self._random = np.random.default_rng()
        self._episode: Episode | None = None

    # ---- defined by each task

    @classmethod
    def make_model(cls) -> Model:
        """The robot of the task, meshed."""
        raise NotImplementedError

    def check_model(self) -> None:
        """Raises an InputError if :attr:`model` lacks something that the task needs."""

    def ranges(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], tuple[str, ...]]:
        """(actuators,) SI values at the first and the second end of each range, and the kinds of :class:`Drive`."""
        raise NotImplementedError

    def observation_size(self) -> int:
        """Length of an observation."""
        raise NotImplementedError

    def begin(self, episode: Episode, options: dict[str, Any]) -> None:
        """Fills in `episode.task` from the generator `self._random` and the options of reset."""

    def time_after(self, episode: Episode) -> float:
        """Program time after the next step."""
        return episode.robot.time

    def observe(self, episode: Episode, seen: Observation) -> FloatArray:
        """(observation_size,) the observation."""
        raise NotImplementedError

    def judge(self, episode: Episode, seen: Observation, action: FloatArray) -> tuple[float, bool, dict[str, Any]]:
        """Reward, whether the task is over, and further entries of info."""
        raise NotImplementedError

    # ---- the interface of Gymnasium

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[FloatArray, dict[str, Any]]:
        """Begins an episode.

        Args:
            seed: whole number from 0, of any size, for everything random in this and later episodes; None: the random
                generator continues.
            options: options of the task, as its class describes them; others are refused.

        Returns:
            (observation_size,) observation, and info, a dict.

        Raises:
            InputError: the seed or an option is not possible; the environment does not change.
        """
        given = self._known_options(options)
        generator = None if seed is None else np.random.default_rng(_check.seed(seed))
        with self._unchanged_by_errors():
            self._random = generator or self._random
            self._episode = episode = Episode(self.model.rest(), np.zeros(len(self._low)))
            self.begin(episode, given)
            seen = episode.robot.observe()
            return self.observe(episode, seen), self._info(seen)

    def step(self, action: Any) -> tuple[FloatArray, float, bool, bool, dict[str, Any]]:
        """One step of the robot. If it fails, the environment does not change.

        Args:
            action: (actuators,) from -1 to 1; larger numbers are clipped.

        Returns:
            observation, reward, terminated, truncated, info
        """
        half = self._before(action)
        result = self.model.step(half.robot, half.inputs)
        with self._unchanged_by_errors():
            return self._after(half, result, half.robot.observe())

    def render(self) -> Any:
        """(height, width, 3) picture of the robot, with ``render_mode="rgb_array"``."""
        if self.render_mode is None:
            return None
        from ..plotting import picture

        return picture(self.episode.robot)

    def close(self) -> None:
        """Does nothing: no files or windows are open."""

    @property
    def unwrapped(self) -> RobotEnv:
        """The environment itself, as in Gymnasium."""
        return self

    @property
    def np_random(self) -> np.random.Generator:
        """Random generator of resets."""
        return self._random

    # ---- states

    @property
    def episode(self) -> Episode:
        """The current episode."""
        if self._episode is None:
            raise InputError("the environment has not begun; call reset() first")
        return self._episode

    def get_state(self) -> Episode:
        """The complete state, which can be pickled and restored in any environment of the same task and robot, as
        :meth:`set_state` says."""
        kept = Episode(
            self.episode.robot.copy(),
            self.episode.pulled.copy(),
            self.episode.steps,
            copy.deepcopy(self.episode.task),
            copy.deepcopy(dict(self._random.bit_generator.state)),
            type(self).__name__,
        )
        return kept

    def set_state(self, episode: Episode) -> None:
        """Restores a state from :meth:`get_state`.

        Its robot must be one that :meth:`Model.state_from` takes. With other material constants, masses, loads or
        friction the robot is at equilibrium again after the next step.

        Raises:
            InputError: the state is of another task or of a robot with another mesh or other actuators, or a part of it
                is missing or not possible; the environment does not change.
        """
        self._take(self._fitting(_check.instance(episode, Episode, "episode")))

    def _fitting(self, episode: Episode) -> Episode:
        """A copy of a state that fits this environment, with a robot of its model."""
        if episode.kind not in ("", type(self).__name__):
            raise InputError(f"the state is one of {episode.kind}, not of {type(self).__name__}")
        robot = self._own_robot(_check.instance(episode.robot, State, "the robot of the state"))
        pulled = _check.finite(episode.pulled, "pulled of the state", (len(self._low),))
        if not ((pulled >= 0) & (pulled <= 1)).all():
            raise InputError("pulled of the state must be from 0 to 1")
        steps = _check.integer(episode.steps, "steps of the state")
        if steps < 0:
            raise InputError(f"steps of the state is {steps}; it must not be negative")
        self.check_task(episode.task)
        random = _generator_state(episode.random, self._random.bit_generator)
        return Episode(robot, pulled.copy(), steps, copy.deepcopy(episode.task), random)

    def _own_robot(self, robot: State) -> State:
        """A copy of the robot of a state, of this environment's model."""
        if robot.model is self.model:
            return robot.copy()
        try:
            return self.model.state_from(robot.bytes())
        except InputError:
            raise InputError("the state is one of an environment with another robot") from None

    def check_task(self, task: dict[str, Any]) -> None:
        """Raises an InputError unless the variables of a state's task are there and possible."""
        if not isinstance(task, dict):
            raise InputError(f"task of the state must be a dict, not {type(task).__name__}")
        for name, shape in self.task_shapes.items():
            if name not in task:
                raise InputError(f"task of the state has no {name!r}")
            _check.finite(task[name], f"task[{name!r}] of the state", shape)

    def _take(self, fitting: Episode) -> None:
        if fitting.random:
            self._random.bit_generator.state = fitting.random
        self._episode = Episode(fitting.robot, fitting.pulled, fitting.steps, fitting.task)

    @contextmanager
    def _unchanged_by_errors(self) -> Iterator[None]:
        """If what is done fails, the episode and the random generator are those before."""
        episode, generator, drawn = self._episode, self._random, self._random.bit_generator.state
        try:
            yield
        except BaseException:
            self._episode, self._random = episode, generator
            generator.bit_generator.state = drawn
            raise

    # ---- the two halves of a step; in between, one robot is solved, or many in parallel

    def _known_options(self, options: Any) -> dict[str, Any]:
        if options is not None and not isinstance(options, Mapping):
            raise InputError(f"options must be a dict, not {type(options).__name__}")
        given = dict(options or {})
        unknown = [] if self.option_names is None else [name for name in given if name not in self.option_names]
        if unknown:
            known = ", ".join(self.option_names or ()) or "none"
            raise InputError(f"there is no option {unknown[0]!r} of {type(self).__name__}; there are: {known}")
        return given

    def _before(self, action: Any) -> Half:
        """Checks the action and prepares the step. Changes nothing, so that a step that fails has no effect."""
        episode = self.episode
        finite = _check.finite(action, "action", (len(self._low),))
        given = np.clip(finite, -1, 1).astype(np.float32)
        pulled = np.clip(episode.pulled + self.largest_change * given, 0, 1)
        return Half(given, pulled, self._inputs_at(pulled, self.time_after(episode)), episode.robot.copy())

    def _inputs_at(self, pulled: npt.NDArray[np.float64], time: float) -> Inputs:
        values = self._low + pulled * (self._high - self._low)
        return Inputs(self.model.actuators, time, self._kinds, values.tolist())

    def _after(
        self, half: Half, result: StepResult, seen: Observation
    ) -> tuple[FloatArray, float, bool, bool, dict[str, Any]]:
        before = self.episode
        self._episode = episode = Episode(half.robot, half.pulled, before.steps + 1, copy.deepcopy(before.task))
        reward, terminated, more = self.judge(episode, seen, half.action)
        info = {**self._info(seen), **more}
        if not result.arrived:
            terminated = True
            info["failed"] = result.reason
        truncated = not terminated and episode.steps >= self.max_steps
        return self.observe(episode, seen), float(reward), bool(terminated), truncated, info

    def _info(self, seen: Observation) -> dict[str, Any]:
        return {"markers": seen.markers, "steps": self.episode.steps}


def _generator_state(given: Any, generator: np.random.BitGenerator) -> dict[str, Any]:
    """A copy of the state of a random generator, which `generator` can take; {}: none."""
    if isinstance(given, dict) and not given:
        return {}
    trial = type(generator)()
    try:
        trial.state = copy.deepcopy(given)
    except (KeyError, OverflowError, TypeError, ValueError):
        raise InputError("random of the state is not that of a random generator of an environment") from None
    return dict(trial.state)
