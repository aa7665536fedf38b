#!/usr/bin/python3
"""An arm with three cables learns to reach: policy search by the cross-entropy method, with numpy alone.

    PYTHONPATH=build/release/python examples/python/learn_to_reach.py [--generations 15] [--picture learning.png]

The policy is linear: the change of each cable's pull from the way to the goal and from how far the cables are pulled. Every generation draws policies around the mean, lets all of them play the same goals side by side, and goes
to the mean of the best (de Boer et al., A Tutorial on the Cross-Entropy Method, 2005). In the end the policy reaches for
goals that it has never seen.
"""

from __future__ import annotations

import argparse

import numpy as np

import pliant
from pliant.envs import Reach, Vector


def act(policies: np.ndarray, observations: np.ndarray) -> np.ndarray:
    """(count, 3) actions of (count, 3, 7) policies at (count, 9) observations."""
    way_cm, pulled = 10 * observations[:, 3:6], observations[:, 6:9]
    seen = np.concatenate([way_cm, pulled, np.ones((len(observations), 1))], axis=1)
    return np.tanh(np.einsum("kij,kj->ki", policies, seen))


def play(envs: Vector, policies: np.ndarray, goals: np.ndarray, steps: int) -> tuple[np.ndarray, np.ndarray]:
    """(policies, goals) returns, and distances in the end (m), of episodes that all end after so many steps."""
    count = len(policies) * len(goals)
    every_policy, every_goal = np.repeat(policies, len(goals), axis=0), np.tile(goals, (len(policies), 1))
    observations = np.stack([env.reset(options={"goal": g})[0] for env, g in zip(envs.envs, every_goal)])
    returns = np.zeros(count)
    for _ in range(steps):
        observations, rewards, *_ = envs.step(act(every_policy, observations))
        returns += rewards
    away = np.linalg.norm(0.1 * observations[:, 3:6], axis=1)
    return returns.reshape(len(policies), -1), away.reshape(len(policies), -1)


class Endless(Reach):
    """All episodes have the same length: standing still at the goal is worth most."""

    tolerance_m = 0.0
    max_steps = 10**9


def goals_of(model: pliant.Model, count: int, seed: int) -> np.ndarray:
    """(count, 3) places that the arm can reach, m."""
    env = Endless(model)
    goals = []
    for k in range(count):
        env.reset(seed=seed + k)
        goals.append(env.episode.task["goal"])
    return np.array(goals)


def learn(
    generations: int, population: int, goals_each: int, steps: int, seed: int, model: pliant.Model | None = None
) -> tuple[list[tuple[float, float]], np.ndarray, pliant.Model]:
    """A learning curve (mean and best distance of each generation, m), the policy, and the robot."""
    model = Endless.make_model() if model is None else model
    envs = Vector(Endless, population * goals_each, model=model)
    random = np.random.default_rng(seed)
    mean, spread = np.zeros((3, 7)), np.ones((3, 7))
    goals = goals_of(model, goals_each, seed)
    curve = []
    for generation in range(generations):
        policies = mean + spread * random.standard_normal((population, 3, 7))
        returns, away = play(envs, policies, goals, steps)
        best = policies[np.argsort(-returns.mean(axis=1))[: max(2, population // 5)]]
        mean, spread = best.mean(axis=0), best.std(axis=0) + 0.02
        curve.append((float(away.mean()), float(away.mean(axis=1).min())))
        print(f"generation {generation + 1:2}: {1e3 * curve[-1][0]:5.1f} mm away on average, best {1e3 * curve[-1][1]:5.1f} mm")
    return curve, mean, model


def draw(curve: list[tuple[float, float]], file: str) -> None:
    """The learning curve."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 3.6), layout="constrained")
    axes = figure.add_subplot()
    generations = range(1, len(curve) + 1)
    axes.plot(generations, [1e3 * c[0] for c in curve], "o-", color="#3d6b9e", label="all policies of a generation")
    axes.plot(generations, [1e3 * c[1] for c in curve], "s--", color="#e07a5f", label="the best of them")
    axes.set_xlabel("generation")
    axes.set_ylabel("distance from the goal in the end (mm)")
    axes.set_ylim(bottom=0)
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(file, dpi=120)


def main() -> None:
    """As the command line says."""
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("--generations", type=int, default=15)
    options.add_argument("--population", type=int, default=24)
    options.add_argument("--goals", type=int, default=6, help="that every policy plays")
    options.add_argument("--steps", type=int, default=12, help="of an episode")
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--picture", help="file of the learning curve")
    given = options.parse_args()
    curve, policy, model = learn(given.generations, given.population, given.goals, given.steps, given.seed)
    unseen = goals_of(model, 12, 10**6)
    _, away = play(Vector(Endless, len(unseen), model=model), policy[None], unseen, given.steps)
    _, idle = play(Vector(Endless, len(unseen), model=model), 0 * policy[None], unseen, given.steps)
    print(f"12 goals it has not seen: {1e3 * away.mean():.1f} mm away in the end; without moving {1e3 * idle.mean():.1f} mm")
    if given.picture:
        draw(curve, given.picture)


if __name__ == "__main__":
    main()
