"""The tasks: reach, follow, grasp, crawl."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from .. import _check
from ..errors import InputError
from ..model import Model
from ..results import Observation
from ..robot import Robot
from .base import Episode, FloatArray, RobotEnv

_SOFT = {"soft": {"youngs_modulus": "1 MPa", "poisson_ratio": 0.45, "density": "1100 kg/m^3"}}


def _floats(*parts: Any) -> FloatArray:
    joined: FloatArray = np.concatenate([np.ravel(p) for p in parts]).astype(np.float32)
    return joined


class _Arm(RobotEnv):
    """An arm of 100 mm with three cables, held at one end. Lengths in observations are in units of 100 mm."""

    #: m, of the arm
    reach_m: ClassVar[float] = 0.1
    #: m, of a cable at most
    most_m: ClassVar[float] = 0.016

    @classmethod
    def make_model(cls) -> Model:
        turns = [2 * np.pi * k / 3 for k in range(3)]
        return Model(
            Robot(
                name="arm",
                length_unit="mm",
                material={"soft": {**_SOFT["soft"], "youngs_modulus": "0.4 MPa"}},
                mesh={"order": 1, "size": "6 mm"},
                body=[{"name": "arm", "material": "soft", "geometry": {"box": [[0, -6, -6], [100, 6, 6]]}}],
                fixed=[{"name": "clamp", "box": [[0, -6, -6], [0, 6, 6]]}],
                marker=[{"name": "tip", "point": [100, 0, 0]}],
                cable=[
                    {
                        "name": f"cable {k}",
                        "points": [[x, 4.5 * float(np.cos(a)), 4.5 * float(np.sin(a))] for x in range(0, 101, 20)],
                        "target": {"shortening": "16 mm"},
                    }
                    for k, a in enumerate(turns)
                ],
            )
        )

    def ranges(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], tuple[str, ...]]:
        # As tensions: three cables of given lengths would fight each other.
        count = len(self.model.cables)
        return np.zeros(count), np.full(count, 2.5), ("tension",) * count

    def observation_size(self) -> int:
        return 3 + 3 + len(self.model.cables)

    def _goal(self, episode: Episode) -> npt.NDArray[np.float64]:
        raise NotImplementedError

    def observe(self, episode: Episode, seen: Observation) -> FloatArray:
        tip = seen.markers["tip"]
        return _floats(tip / self.reach_m, (self._goal(episode) - tip) / self.reach_m, episode.pulled)

    def _somewhere(self) -> npt.NDArray[np.float64]:
        """A place that the tip can get to: that of random tensions."""
        pulled = self._random.uniform(0, 1, len(self._low))
        pulled[int(self._random.integers(len(pulled)))] = 0
        inputs = self._inputs_at(pulled, 0.0)
        return np.array(self.model.solve(inputs).observe().markers["tip"])


class Reach(_Arm):
    """The tip of an arm with three cables goes to a place.

    Observation (9,): tip (3) and the way from tip to goal (3) in units of 100 mm, how far each cable is pulled (3).
    Action (3,): change of the pull of each cable. Reward: minus the distance in units of 100 mm, and 1 where the goal
    is reached within 2 mm, which ends the episode. The goal is one that the arm can reach;
    ``options={"goal": [x, y, z]}`` (m) sets it.
    """

    #: m
    tolerance_m: ClassVar[float] = 0.002

    def begin(self, episode: Episode, options: dict[str, Any]) -> None:
        goal = options.get("goal")
        episode.task["goal"] = self._somewhere() if goal is None else _check.numbers(goal, "goal", (3,))

    def _goal(self, episode: Episode) -> npt.NDArray[np.float64]:
        goal: npt.NDArray[np.float64] = episode.task["goal"]
        return goal

    def judge(self, episode: Episode, seen: Observation, action: FloatArray) -> tuple[float, bool, dict[str, Any]]:
        away = float(np.linalg.norm(seen.markers["tip"] - self._goal(episode)))
        reached = away < self.tolerance_m
        return reached - away / self.reach_m, reached, {"distance_m": away, "is_success": reached}


class Follow(_Arm):
    """The tip of an arm with three cables follows a point on a circle.

    Observation (9,): tip (3) and the way from tip to the point's next place (3) in units of 100 mm, how far each cable
    is pulled (3). Action (3,): change of the pull of each cable. Reward: minus the distance in units of 100 mm. The
    circle begins at a random angle; ``options={"angle": radians, "radius": m}`` set it.
    """

    max_steps: ClassVar[int] = 40

    def begin(self, episode: Episode, options: dict[str, Any]) -> None:
        angle = options.get("angle", self._random.uniform(0, 2 * np.pi))
        episode.task["angle"] = _check.number(angle, "angle")
        episode.task["radius"] = _check.number(options.get("radius", 0.03), "radius")

    def _place(self, episode: Episode, step: int) -> npt.NDArray[np.float64]:
        share = min(1.0, step / 8)  # from the middle out, then around
        angle = episode.task["angle"] + 2 * np.pi * step / self.max_steps
        out = share * episode.task["radius"]
        return np.array([0.1 - 4 * out**2, out * np.cos(angle), out * np.sin(angle)])

    def _goal(self, episode: Episode) -> npt.NDArray[np.float64]:
        return self._place(episode, episode.steps + 1)

    def judge(self, episode: Episode, seen: Observation, action: FloatArray) -> tuple[float, bool, dict[str, Any]]:
        away = float(np.linalg.norm(seen.markers["tip"] - self._place(episode, episode.steps)))
        return -away / self.reach_m, False, {"distance_m": away}


class Grasp(RobotEnv):
    """Two fingers close on a ball and hold it with a wanted force. The ball is fixed: free bodies are not simulated yet.

    Observation (6,): how far each cable is pulled (2), tension of each in N (2), force on the ball over the wanted one,
    and that in N. Action (2,): change of the pull of each cable. Reward: minus the relative error of the force along x,
    at most 1. The wanted force of each finger is random; ``options={"force": N}`` sets it.
    """

    @classmethod
    def make_model(cls) -> Model:
        finger = {"box": [[11, -5, -50], [17, 5, 0]]}
        cable = [[12, 0, 1], [12, 0, -12], [12, 0, -24], [12, 0, -36], [12, 0, -47]]
        mirror = [[-x, y, z] for x, y, z in cable]
        return Model(
            Robot(
                name="gripper",
                length_unit="mm",
                material=_SOFT,
                mesh={"order": 1, "size": "5 mm"},
                body=[
                    {"name": "palm", "material": "soft", "geometry": {"box": [[-17, -5, 0], [17, 5, 6]]}},
                    {"name": "right", "material": "soft", "geometry": finger},
                    {"name": "left", "material": "soft", "geometry": {"box": [[-17, -5, -50], [-11, 5, 0]]}},
                ],
                fixed=[{"name": "arm", "plane": {"point": [0, 0, 6], "normal": [0, 0, 1]}}],
                marker=[{"name": "right", "point": [11, 0, -50]}, {"name": "left", "point": [-11, 0, -50]}],
                cable=[
                    {"name": "right", "points": cable, "target": {"shortening": "5 mm"}},
                    {"name": "left", "points": mirror, "target": {"shortening": "5 mm"}},
                ],
                obstacle=[
                    {
                        "name": "ball",
                        "geometry": {"sphere": {"center": [0, 0, -40], "radius": 9}},
                        "friction": 0.5,
                    }
                ],
                contact={"self": False},
            )
        )

    def ranges(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], tuple[str, ...]]:
        lengths = self.model.rest().inputs.values_SI
        return lengths, lengths - 0.007, ("length", "length")

    def observation_size(self) -> int:
        return 6

    def begin(self, episode: Episode, options: dict[str, Any]) -> None:
        force = _check.number(options.get("force", self._random.uniform(0.1, 0.4)), "force")
        if not force > 0:
            raise InputError(f"force is {force}; it must be above 0")
        episode.task["force"] = force

    def _pressed(self, episode: Episode) -> float:
        """N, of the two fingers together along x: their sum vanishes, so it is taken from the sides."""
        forces = self.model.contact_forces(episode.robot)[:, 0]
        return float(np.abs(forces).sum()) / 2

    def observe(self, episode: Episode, seen: Observation) -> FloatArray:
        force = episode.task["force"]
        tensions = [cable.tension_N for cable in seen.cables.values()]
        return _floats(episode.pulled, tensions, self._pressed(episode) / force, force)

    def judge(self, episode: Episode, seen: Observation, action: FloatArray) -> tuple[float, bool, dict[str, Any]]:
        pressed, force = self._pressed(episode), episode.task["force"]
        return -min(1.0, abs(pressed - force) / force), False, {"force_N": pressed}


class Crawl(RobotEnv):
    """A worm with two cables under its back half and its front half crawls over a floor with friction, in time.

    Observation (8,): heights of head, middle and tail over the floor, velocities along x of the same, in cm and dm/s;
    how far each cable is pulled (2). Action (2,): change of the pull of each cable in 20 ms. Reward: way of the middle
    along x in this step, cm. The worm is held in its plane of symmetry alone.
    """

    max_steps: ClassVar[int] = 100
    largest_change: ClassVar[float] = 0.5
    #: s, of a step
    step_s: ClassVar[float] = 0.02

    @classmethod
    def make_model(cls) -> Model:
        return Model(
            Robot(
                name="worm",
                length_unit="mm",
                material={"soft": {"youngs_modulus": "0.3 MPa", "poisson_ratio": 0.4, "density": "1100 kg/m^3"}},
                mesh={"order": 1, "size": "6 mm"},
                body=[{"name": "worm", "material": "soft", "geometry": {"box": [[0, 0, 0.2], [80, 8, 8.2]]}}],
                fixed=[{"name": "plane", "plane": {"point": [0, 0, 0], "normal": [0, 1, 0]}, "directions": "normal"}],
                marker=[
                    {"name": "tail", "point": [0, 0, 4]},
                    {"name": "middle", "point": [40, 0, 4]},
                    {"name": "head", "point": [80, 0, 4]},
                ],
                cable=[
                    {"name": "rear", "points": [[2, 0, 1.2], [20, 0, 1.2], [38, 0, 1.2]], "target": {"shortening": "5 mm"}},
                    {"name": "front", "points": [[42, 0, 1.2], [60, 0, 1.2], [78, 0, 1.2]], "target": {"shortening": "5 mm"}},
                ],
                obstacle=[{"name": "floor", "plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}, "friction": 0.6}],
                contact={"self": False},
                program={"duration": "10 s", "time_step": "20 ms", "gravity": [0, 0, -9.81], "mass_damping": 2},
            )
        )

    def ranges(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], tuple[str, ...]]:
        lengths = self.model.rest().inputs.values_SI
        return lengths, lengths - 0.006, ("length", "length")

    def observation_size(self) -> int:
        return 8

    def begin(self, episode: Episode, options: dict[str, Any]) -> None:
        episode.task["places"] = episode.robot.markers()
        episode.task["speeds"] = np.zeros(3)

    def time_after(self, episode: Episode) -> float:
        return (episode.steps + 1) * self.step_s

    def observe(self, episode: Episode, seen: Observation) -> FloatArray:
        return _floats(100 * episode.task["places"][:, 2], 10 * episode.task["speeds"], episode.pulled)

    def judge(self, episode: Episode, seen: Observation, action: FloatArray) -> tuple[float, bool, dict[str, Any]]:
        places = np.array([seen.markers[name] for name in self.model.markers])
        moved = (places - episode.task["places"])[:, 0]
        episode.task["places"], episode.task["speeds"] = places, moved / self.step_s
        return 100 * float(moved[1]), False, {"way_m": float(places[1, 0]) - 0.04}
