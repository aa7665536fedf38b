"""What all environments share: the signatures of Gymnasium 0.29, seeds, states that are saved and set."""

from __future__ import annotations

import copy
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from .. import _check
from .._pliant import StepResult
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


@dataclass
class Episode:
    """Everything about an environment that changes: a value that can be copied, pickled, kept and set again."""

    #: of the robot
    robot: State
    #: (actuators,) where each stands in its range, 0 to 1
    pulled: npt.NDArray[np.float64]
    #: steps since the reset
    steps: int = 0
    #: what the task remembers, by name
    task: dict[str, Any] = field(default_factory=dict)
    #: of the generator that resets draw from
    random: dict[str, Any] = field(default_factory=dict)


class RobotEnv(_Base):  # type: ignore[misc]
    """A robot, its actuators as actions, a task.

    An action says for each actuator how far it goes in this step: -1 and 1 are the most it may, towards the lower and
    the upper end of its range. Every step is an equilibrium of the whole robot, or a step in time. The same seed and
    the same actions give the same numbers to the last bit, on any number of threads, alone or in a
    :class:`~pliant.envs.Vector`.

    A step that finds no equilibrium ends the episode: `terminated` is True and ``info["failed"]`` says why.

    What Gymnasium's own environments cannot do: :meth:`get_state` and :meth:`set_state`.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 10}
    render_mode: str | None = None
    spec: Any = None

    #: Steps until an episode is truncated.
    max_steps: ClassVar[int] = 25
    #: Largest change of an actuator in a step, as a share of its range.
    largest_change: ClassVar[float] = 0.15

    def __init__(self, model: Model | None = None, *, render_mode: str | None = None) -> None:
        if render_mode not in (None, "rgb_array"):
            raise InputError(f'render_mode is None or "rgb_array", not {render_mode!r}')
        self.render_mode = render_mode
        self.model = self.make_model() if model is None else _check.instance(model, Model, "model")
        self._low, self._high, self._kinds = self.ranges()
        count = len(self._low)
        self.action_space = box(-1.0, 1.0, (count,), np.float32)
        self.observation_space = box(-np.inf, np.inf, (self.observation_size(),), np.float32)
        self._random = np.random.default_rng()
        self._episode: Episode | None = None

    # ---- what a task says

    @classmethod
    def make_model(cls) -> Model:
        """The robot of the task, meshed."""
        raise NotImplementedError

    def ranges(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], tuple[str, ...]]:
        """(actuators,) SI values at the lower and the upper end of each range, and the kinds of :class:`Drive`."""
        raise NotImplementedError

    def observation_size(self) -> int:
        """Numbers of an observation."""
        raise NotImplementedError

    def begin(self, episode: Episode, options: dict[str, Any]) -> None:
        """Fills in `episode.task` from the generator `self._random` and the options of reset."""

    def time_after(self, episode: Episode) -> float:
        """Of the program, after the next step."""
        return episode.robot.time

    def observe(self, episode: Episode, seen: Observation) -> FloatArray:
        """(observation_size,) what the policy sees."""
        raise NotImplementedError

    def judge(self, episode: Episode, seen: Observation, action: FloatArray) -> tuple[float, bool, dict[str, Any]]:
        """Reward, whether the task is over, and what else is worth knowing."""
        raise NotImplementedError

    # ---- the interface of Gymnasium

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[FloatArray, dict[str, Any]]:
        """Begins an episode.

        Args:
            seed: from which everything random of this and later episodes follows; None: goes on as it was.
            options: of the task.

        Returns:
            (observation_size,) observation, and a dict.
        """
        self._begin(seed, options)
        episode = self.episode
        seen = episode.robot.observe()
        return self.observe(episode, seen), self._info(seen)

    def step(self, action: Any) -> tuple[FloatArray, float, bool, bool, dict[str, Any]]:
        """A step of the robot.

        Args:
            action: (actuators,) from -1 to 1; beyond is cut off.

        Returns:
            observation, reward, terminated, truncated, info
        """
        inputs, given = self._before(action)
        result = self.model.step(self.episode.robot, inputs)
        return self._after(given, result, self.episode.robot.observe())

    def render(self) -> Any:
        """(height, width, 3) picture of the robot, with ``render_mode="rgb_array"``."""
        if self.render_mode is None:
            return None
        from ..plotting import picture

        return picture(self.episode.robot)

    def close(self) -> None:
        """Nothing is held open."""

    @property
    def unwrapped(self) -> RobotEnv:
        """Itself."""
        return self

    @property
    def np_random(self) -> np.random.Generator:
        """What resets draw from."""
        return self._random

    # ---- states

    @property
    def episode(self) -> Episode:
        """The episode as it stands."""
        if self._episode is None:
            raise InputError("the environment has not begun; call reset() first")
        return self._episode

    def get_state(self) -> Episode:
        """Everything that changes: to be kept, pickled, and set again, here or in another environment of the task."""
        kept = Episode(
            self.episode.robot.copy(),
            self.episode.pulled.copy(),
            self.episode.steps,
            copy.deepcopy(self.episode.task),
            copy.deepcopy(dict(self._random.bit_generator.state)),
        )
        return kept

    def set_state(self, episode: Episode) -> None:
        """Goes on from where :meth:`get_state` was called."""
        given = _check.instance(episode, Episode, "episode")
        robot = given.robot
        if robot.model is not self.model:
            robot = self.model.state_from(robot.bytes())
        self._episode = Episode(robot.copy(), given.pulled.copy(), given.steps, copy.deepcopy(given.task))
        self._random.bit_generator.state = copy.deepcopy(given.random)

    # ---- the two halves of a step, between which robots are solved alone or many at once

    def _begin(self, seed: int | None, options: dict[str, Any] | None) -> None:
        if seed is not None:
            self._random = np.random.default_rng(_check.integer(seed, "seed"))
        self._episode = Episode(self.model.rest(), np.zeros(len(self._low)))
        self.begin(self._episode, {} if options is None else dict(options))

    def _before(self, action: Any) -> tuple[Inputs, FloatArray]:
        episode = self.episode
        given = np.clip(_check.numbers(action, "action", (len(self._low),)), -1, 1).astype(np.float32)
        if not np.isfinite(given).all():
            raise InputError("the action is not finite")
        episode.pulled = np.clip(episode.pulled + self.largest_change * given, 0, 1)
        return self._inputs_at(episode.pulled, self.time_after(episode)), given

    def _inputs_at(self, pulled: npt.NDArray[np.float64], time: float) -> Inputs:
        values = self._low + pulled * (self._high - self._low)
        return Inputs(self.model.actuators, time, self._kinds, values.tolist())

    def _after(
        self, given: FloatArray, result: StepResult, seen: Observation
    ) -> tuple[FloatArray, float, bool, bool, dict[str, Any]]:
        episode = self.episode
        episode.steps += 1
        reward, terminated, more = self.judge(episode, seen, given)
        info = {**self._info(seen), **more}
        if not result.arrived:
            terminated = True
            info["failed"] = result.reason
        truncated = not terminated and episode.steps >= self.max_steps
        return self.observe(episode, seen), float(reward), bool(terminated), truncated, info

    def _info(self, seen: Observation) -> dict[str, Any]:
        return {"markers": seen.markers, "steps": self.episode.steps}
