"""Many environments of one task: their robots are solved in parallel."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from .. import _check
from ..batch import MOST_ROBOTS, Batch
from ..errors import InputError
from .base import Episode, FloatArray, Half, RobotEnv
from .spaces import box

Flags = npt.NDArray[np.bool_]


class Vector:
    """Environments of one task, stepped by a :class:`pliant.Batch`, with the same results as each of them alone.

    With the signatures of vector environments of Gymnasium 0.29: an environment whose episode is over is reset at once,
    its observation is that of the new episode, and ``infos["final_observation"]`` and ``infos["final_info"]`` hold the
    last ones of the episode that is over. Infos that are numbers or flags are arrays of them, 0 and False where the flags
    ``infos["_" + key]`` say that an environment has none.

    Args:
        task: a class of environments, as :class:`Reach`.
        count: number of environments.
        threads: number of threads; 0: one for each core.
        arguments: passed to each environment.
    """

    def __init__(self, task: type[RobotEnv], count: int, *, threads: int = 0, **arguments: Any) -> None:
        if not (isinstance(task, type) and issubclass(task, RobotEnv)):
            raise TypeError("task must be a class of environments, as pliant.envs.Reach")
        self.num_envs = _check.integer(count, "count")
        if not 1 <= self.num_envs <= MOST_ROBOTS:
            raise InputError(f"count is {count}; 1 to {MOST_ROBOTS:,} environments are possible")
        model = arguments.pop("model", None) or task.make_model()
        self.envs = [task(model=model, **arguments) for _ in range(self.num_envs)]
        self._batch = Batch(model, self.num_envs, threads=threads)
        one = self.envs[0]
        self.single_action_space = one.action_space
        self.single_observation_space = one.observation_space
        self.action_space = box(-1.0, 1.0, (self.num_envs, *one.action_space.shape), np.float32)
        self.observation_space = box(-np.inf, np.inf, (self.num_envs, *one.observation_space.shape), np.float32)

    def reset(
        self, *, seed: int | Sequence[int] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[FloatArray, dict[str, Any]]:
        """Begins all episodes; environment k has the seed + k, or the k-th of a list. If it fails, no environment
        changes.

        Returns:
            (count, observation_size) observations, and infos by key.
        """
        seeds = self._seeds(seed)
        with self._unchanged_by_errors():
            found = [env.reset(seed=s, options=options) for env, s in zip(self.envs, seeds)]
        return np.stack([f[0] for f in found]), _gathered([f[1] for f in found])

    def step(self, actions: Any) -> tuple[FloatArray, npt.NDArray[np.float64], Flags, Flags, dict[str, Any]]:
        """One step of all environments. If it fails, for one bad action for example, no environment changes.

        Args:
            actions: (count, actuators).

        Returns:
            (count, observation_size) observations, (count,) rewards, terminated and truncated, infos by key.
        """
        given = _check.numbers(actions, "actions", (self.num_envs, None))
        halves = [self._half(k, action) for k, action in enumerate(given)]
        robots = [half.robot for half in halves]
        results = self._batch.step(robots, [half.inputs for half in halves])
        seen = self._batch.observe(robots)
        with self._unchanged_by_errors():
            found = [env._after(h, r, s) for env, h, r, s in zip(self.envs, halves, results, seen)]
            observations, infos = self._begun_again(found)
        rewards, ended, cut = (np.array([f[k] for f in found]) for k in (1, 2, 3))
        return np.stack(observations), rewards, ended, cut, _gathered(infos)

    def _begun_again(self, found: list[Any]) -> tuple[list[FloatArray], list[dict[str, Any]]]:
        """Observations and infos of steps, of new episodes where one is over."""
        observations, infos = [f[0] for f in found], [f[4] for f in found]
        for k, (last, _, terminated, truncated, info) in enumerate(found):
            if terminated or truncated:
                observations[k], begun = self.envs[k].reset()
                infos[k] = {**begun, "final_observation": last, "final_info": info}
        return observations, infos

    @contextmanager
    def _unchanged_by_errors(self) -> Iterator[None]:
        with ExitStack() as all_of_them:
            for env in self.envs:
                all_of_them.enter_context(env._unchanged_by_errors())
            yield

    def _half(self, k: int, action: Any) -> Half:
        try:
            return self.envs[k]._before(action)
        except InputError as error:
            raise InputError(f"environment {k}: {error}") from None

    def get_states(self) -> list[Episode]:
        """:meth:`RobotEnv.get_state` of each environment."""
        return [env.get_state() for env in self.envs]

    def set_states(self, episodes: Iterable[Episode]) -> None:
        """Restores the state of each environment. If one of them does not fit, no environment changes."""
        given = _check.several(episodes, Episode, "episodes")
        if len(given) != self.num_envs:
            raise InputError(f"{len(given)} states for {self.num_envs} environments")
        fitting = [self._fitting(k, episode) for k, episode in enumerate(given)]
        for env, episode in zip(self.envs, fitting):
            env._take(episode)

    def _fitting(self, k: int, episode: Episode) -> Episode:
        try:
            return self.envs[k]._fitting(episode)
        except InputError as error:
            raise InputError(f"environment {k}: {error}") from None

    def close(self) -> None:
        """Does nothing: no files or windows are open."""

    def _seeds(self, seed: int | Sequence[int] | None) -> list[int | None]:
        if seed is None:
            return [None] * self.num_envs
        if not _check.is_several(seed):
            return [_check.seed(seed) + k for k in range(self.num_envs)]
        each = list(cast(Iterable[Any], seed))
        if len(each) != self.num_envs:
            raise InputError(f"{len(each)} seeds for {self.num_envs} environments")
        return [None if one is None else _check.seed(one, "each seed") for one in each]

    def __len__(self) -> int:
        return self.num_envs


def _gathered(infos: list[dict[str, Any]]) -> dict[str, Any]:
    """(count,) values for each key, and for each ``_key`` (count,) flags of the environments that have it."""
    gathered: dict[str, Any] = {}
    for key in sorted({key for info in infos for key in info}):
        gathered[key] = _array_of(infos, key)
        gathered["_" + key] = np.array([key in info for info in infos])
    return gathered


def _array_of(infos: list[dict[str, Any]], key: str) -> npt.NDArray[Any]:
    """Flags, whole numbers or numbers, 0 where an environment has none; anything else as objects, there None."""
    dtype = _dtype_of([info[key] for info in infos if key in info])
    if dtype is not object:
        return np.array([info.get(key, 0) for info in infos], dtype=dtype)
    values = np.empty(len(infos), dtype=object)
    for k, info in enumerate(infos):
        values[k] = info.get(key)
    return values


def _dtype_of(values: list[Any]) -> type:
    flags = [isinstance(value, (bool, np.bool_)) for value in values]
    if any(flags):
        return bool if all(flags) else object
    if all(isinstance(value, (int, np.integer)) and abs(int(value)) < 2**63 for value in values):
        return int
    if all(isinstance(value, (int, float, np.integer, np.floating)) for value in values):
        return float
    return object
