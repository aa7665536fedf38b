"""Many environments of one task at once: their robots are solved side by side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import _check
from ..batch import Batch
from ..errors import InputError
from .base import Episode, FloatArray, RobotEnv
from .spaces import box

Flags = npt.NDArray[np.bool_]


class Vector:
    """Environments of one task, stepped by a :class:`pliant.Batch`; the numbers are those of each alone.

    With the signatures of vector environments of Gymnasium 0.29: an environment whose episode is over is reset at once,
    its observation is that of the new episode, and ``infos["final_observation"]`` and ``infos["final_info"]`` hold the
    last ones of the old.

    Args:
        task: a class of environments, as :class:`Reach`.
        count: how many.
        threads: 0: one for each core.
        arguments: of each environment.
    """

    def __init__(self, task: type[RobotEnv], count: int, *, threads: int = 0, **arguments: Any) -> None:
        if not (isinstance(task, type) and issubclass(task, RobotEnv)):
            raise TypeError("task must be a class of environments, as pliant.envs.Reach")
        self.num_envs = _check.integer(count, "count")
        if self.num_envs < 1:
            raise InputError(f"count is {count}; it must be at least 1")
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
        """Begins all episodes; environment k has the seed + k, or its own of a list.

        Returns:
            (count, observation_size) observations, and infos by key.
        """
        found = [env.reset(seed=s, options=options) for env, s in zip(self.envs, self._seeds(seed))]
        return np.stack([f[0] for f in found]), _gathered([f[1] for f in found])

    def step(self, actions: Any) -> tuple[FloatArray, npt.NDArray[np.float64], Flags, Flags, dict[str, Any]]:
        """A step of all.

        Args:
            actions: (count, actuators).

        Returns:
            (count, observation_size) observations, (count,) rewards, terminated and truncated, infos by key.
        """
        given = _check.numbers(actions, "actions", (self.num_envs, None))
        halves = [env._before(action) for env, action in zip(self.envs, given)]
        robots = [env.episode.robot for env in self.envs]
        results = self._batch.step(robots, [inputs for inputs, _ in halves])
        seen = self._batch.observe(robots)
        found = [env._after(h[1], r, s) for env, h, r, s in zip(self.envs, halves, results, seen)]
        observations, infos = [f[0] for f in found], [f[4] for f in found]
        for k, (_, _, terminated, truncated, info) in enumerate(found):
            if terminated or truncated:
                last = observations[k]
                observations[k], infos[k] = self.envs[k].reset()
                infos[k] = {**infos[k], "final_observation": last, "final_info": info}
        rewards, ended, cut = (np.array([f[k] for f in found]) for k in (1, 2, 3))
        return np.stack(observations), rewards, ended, cut, _gathered(infos)

    def get_states(self) -> list[Episode]:
        """Of each environment what :meth:`RobotEnv.get_state` gives."""
        return [env.get_state() for env in self.envs]

    def set_states(self, episodes: Sequence[Episode]) -> None:
        """Goes on from there."""
        if len(episodes) != self.num_envs:
            raise InputError(f"{len(episodes)} states for {self.num_envs} environments")
        for env, episode in zip(self.envs, episodes):
            env.set_state(episode)

    def close(self) -> None:
        """Nothing is held open."""

    def _seeds(self, seed: int | Sequence[int] | None) -> list[int | None]:
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, (int, np.integer)):
            return [int(seed) + k for k in range(self.num_envs)]
        if len(seed) != self.num_envs:
            raise InputError(f"{len(seed)} seeds for {self.num_envs} environments")
        return list(seed)

    def __len__(self) -> int:
        return self.num_envs


def _gathered(infos: list[dict[str, Any]]) -> dict[str, Any]:
    """By key, (count,) objects, and beside each ``_key``, (count,) which environments have it."""
    gathered: dict[str, Any] = {}
    for key in sorted({key for info in infos for key in info}):
        values = np.empty(len(infos), dtype=object)
        for k, info in enumerate(infos):
            values[k] = info.get(key)
        gathered[key] = values
        gathered["_" + key] = np.array([key in info for info in infos])
    return gathered
