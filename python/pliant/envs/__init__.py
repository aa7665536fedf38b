"""Soft robots as environments, with the signatures of Gymnasium 0.29, which need not be installed.

    env = pliant.envs.Reach()
    observation, info = env.reset(seed=1)
    observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
    kept = env.get_state()                     # the complete state: env.set_state(kept) restores it

    many = pliant.envs.Vector(pliant.envs.Reach, 64)      # in parallel on all cores

If Gymnasium is installed, they are registered as pliant/Reach-v0, pliant/Follow-v0, pliant/Grasp-v0 and
pliant/Crawl-v0.
"""

from __future__ import annotations

from .base import Episode, RobotEnv
from .tasks import Crawl, Follow, Grasp, Reach
from .vector import Vector

__all__ = ["Crawl", "Episode", "Follow", "Grasp", "Reach", "RobotEnv", "Vector"]


def _register() -> None:
    try:
        from gymnasium.envs.registration import register, registry
    except ImportError:
        return
    for task in (Crawl, Follow, Grasp, Reach):
        name = f"pliant/{task.__name__}-v0"
        if name not in registry:
            register(id=name, entry_point=f"pliant.envs:{task.__name__}")


_register()
