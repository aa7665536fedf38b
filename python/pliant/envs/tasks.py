"""The tasks: reach, follow, grasp, crawl."""

from __future__ import annotations

from collections.abc import Mapping
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


def _within(value: Any, what: str, shape: tuple[int, ...], low: float, high: float) -> npt.NDArray[np.float64]:
    """Numbers of this shape between two bounds."""
    found = _check.finite(value, what, shape)
    if not ((found >= low) & (found <= high)).all():
        raise InputError(f"{what} is {_check._shown(found.tolist())}; it must be from {low:g} to {high:g}")
    return found


def _need(env: RobotEnv, there: bool, what: str) -> None:
    if not there:
        raise InputError(f"{type(env).__name__} needs {what}; the robot {env.model.robot.name!r} has none")


def _need_two_cables(env: RobotEnv) -> None:
    count = len(env.model.cables)
    if count != 2:
        raise InputError(f"{type(env).__name__} needs 2 cables; the robot {env.model.robot.name!r} has {count}")


def _need_no_chambers(env: RobotEnv) -> None:
    if env.model.chambers:
        raise InputError(
            f"{type(env).__name__} moves cables alone; the robot {env.model.robot.name!r} has chambers, too: "
            f"{', '.join(env.model.chambers)}"
        )


class _Arm(RobotEnv):
    """An arm of 100 mm with three cables, held at one end. Lengths in observations are in units of 100 mm."""

    #: m, length of the arm
    reach_m: ClassVar[float] = 0.1
    #: m, largest pull of a cable
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

    def check_model(self) -> None:
        _need(self, "tip" in self.model.markers, 'a marker "tip"')
        _need(self, bool(self.model.cables), "cables")
        _need_no_chambers(self)

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
        """A position that the tip can reach: that at random tensions."""
        pulled = self._random.uniform(0, 1, len(self._low))
        pulled[int(self._random.integers(len(pulled)))] = 0
        inputs = self._inputs_at(pulled, 0.0)
        return np.array(self.model.solve(inputs).observe().markers["tip"])


class Reach(_Arm):
    """The tip of an arm with three cables moves to a goal.

    Observation (9,): position of the tip (3) and vector from the tip to the goal (3), in units of 100 mm; pull of each
    cable, 0 to 1 (3). Action (3,): change of the pull of each cable. Reward: minus the distance in units of 100 mm,
    plus 1 if the goal is reached within 2 mm, which ends the episode. The goal is random and within reach of the arm;
    ``options={"goal": [x, y, z]}`` (m) sets it, each from -1 to 1.
    """

    #: m
    tolerance_m: ClassVar[float] = 0.002
    option_names: ClassVar[tuple[str, ...] | None] = ("goal",)
    task_shapes: ClassVar[Mapping[str, tuple[int, ...]]] = {"goal": (3,)}

    def begin(self, episode: Episode, options: dict[str, Any]) -> None:
        goal = options.get("goal")
        episode.task["goal"] = self._somewhere() if goal is None else _within(goal, "goal", (3,), -1, 1)

    def _goal(self, episode: Episode) -> npt.NDArray[np.float64]:
        goal: npt.NDArray[np.float64] = episode.task["goal"]
        return goal

    def judge(self, episode: Episode, seen: Observation, action: FloatArray) -> tuple[float, bool, dict[str, Any]]:
        away = float(np.linalg.norm(seen.markers["tip"] - self._goal(episode)))
        reached = away < self.tolerance_m
        return reached - away / self.reach_m, reached, {"distance_m": away, "is_success": reached}


class Follow(_Arm):
    """The tip of an arm with three cables follows a point on a circle.

    Observation (9,): position of the tip (3) and vector from the tip to the next position of the point (3), in units of
    100 mm; pull of each cable, 0 to 1 (3). Action (3,): change of the pull of each cable. Reward: minus the distance in
    units of 100 mm. The circle begins at a random angle; ``options={"angle": radians, "radius": m}`` sets both, the
    radius from 0 to 0.1.
    """

    max_steps: ClassVar[int] = 40
    option_names: ClassVar[tuple[str, ...] | None] = ("angle", "radius")
    task_shapes: ClassVar[Mapping[str, tuple[int, ...]]] = {"angle": (), "radius": ()}

    def begin(self, episode: Episode, options: dict[str, Any]) -> None:
        angle = options.get("angle", self._random.uniform(0, 2 * np.pi))
        episode.task["angle"] = _check.number(angle, "angle")
        radius = _check.number(options.get("radius", 0.03), "radius")
        episode.task["radius"] = float(_within(radius, "radius", (), 0, self.reach_m))

    def check_task(self, task: dict[str, Any]) -> None:
        super().check_task(task)
        _within(task["radius"], "task['radius'] of the state", (), 0, self.reach_m)

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


class _InTime(RobotEnv):
    """A task whose steps are motion in time."""

    #: s, duration of a step
    step_s: ClassVar[float] = 0.02
    #: m, largest pull of a cable
    most_m: ClassVar[float] = 0.004

    def check_model(self) -> None:
        _need_two_cables(self)
        _need_no_chambers(self)

    def ranges(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], tuple[str, ...]]:
        lengths = self.model.rest().inputs.values_SI
        return lengths, lengths - self.most_m, ("length",) * len(lengths)

    def time_after(self, episode: Episode) -> float:
        return (episode.steps + 1) * self.step_s


class Grasp(_InTime):
    """Two fingers close on a cube that stands on a table, and hold it while the table is lowered; a motion in time.

    The cube, a rigid body of 20 mm with mass, is held by friction alone. The table begins to move down after 0.3 s, and
    is 30 mm lower after 0.9 s.

    Observation (11,): displacement of the cube from its start (3) in cm, its velocity (3) in dm/s, pull of each cable,
    0 to 1 (2), tension of each in N (2), time until the table begins to move, at least 0, in s. Action (2,): change of
    the pull of each cable in 20 ms. Reward: minus the distance of the cube from its start in cm, at most 1, and minus a
    tenth of the mean square of the pulls; if the cube has fallen by more than 10 mm, the episode ends with -10. The
    mass of the cube is set in the model: ``Grasp(Grasp.make_model(mass_g=20))``. The pulls that the fingers begin with
    are random: ``options={"pulled": [0.1, 0.2]}`` sets them, each from 0 to 1.
    """

    max_steps: ClassVar[int] = 60
    option_names: ClassVar[tuple[str, ...] | None] = ("pulled",)
    task_shapes: ClassVar[Mapping[str, tuple[int, ...]]] = {"stood": (3,), "place": (3,), "speed": (3,)}
    largest_change: ClassVar[float] = 0.2
    most_m: ClassVar[float] = 0.0025
    #: s, time at which the table begins to move
    table_goes_s: ClassVar[float] = 0.3
    #: m, distance that the cube may fall
    fallen_m: ClassVar[float] = 0.01

    @classmethod
    def make_model(cls, mass_g: float = 8.0) -> Model:
        finger = {"difference": [{"box": [[12, -5, -34], [18, 5, 0]]}, {"box": [[15.5, -6, -10], [19, 6, -4]]}]}
        cable = [[13, 0, 1], [13, 0, -5], [13, 0, -10], [13, 0, -18], [13, 0, -30]]
        mirror = [[-x, y, z] for x, y, z in cable]
        return Model(
            Robot(
                name="gripper",
                length_unit="mm",
                material=_SOFT,
                mesh={"order": 1, "size": "4 mm"},
                body=[
                    {"name": "palm", "material": "soft", "geometry": {"box": [[-22, -6, 0], [22, 6, 5]]}},
                    {"name": "right", "material": "soft", "geometry": finger},
                    {"name": "left", "material": "soft", "geometry": {"rotate": 180, "axis": [0, 0, 1], "of": finger}},
                ],
                fixed=[{"name": "arm", "plane": {"point": [0, 0, 5], "normal": [0, 0, 1]}}],
                marker=[{"name": "right", "point": [12, 0, -34]}, {"name": "left", "point": [-12, 0, -34]}],
                cable=[
                    {"name": "right", "points": cable, "eyelet_radius": "1.5 mm", "target": {"shortening": "2 mm"}},
                    {"name": "left", "points": mirror, "eyelet_radius": "1.5 mm", "target": {"shortening": "2 mm"}},
                ],
                obstacle=[
                    {
                        "name": "table",
                        "plane": {"point": [0, 0, -38], "normal": [0, 0, 1]},
                        "friction": 0.5,
                        "move": [0, 0, -30],
                    }
                ],
                object=[
                    {
                        "name": "cube",
                        "geometry": {"box": [[-10, -10, -38], [10, 10, -18]]},
                        "mass": f"{mass_g} g",
                        "friction": 0.6,
                    }
                ],
                contact={"self": False, "distance": "0.2 mm"},
                program={
                    "duration": "1.2 s",
                    "time_step": "20 ms",
                    "stiffness_damping": 0.002,
                    "gravity": [0, 0, -9.81],
                    "key": [{"time": "0.3 s", "table": 0}, {"time": "0.9 s", "table": 1}],
                },
            )
        )

    def check_model(self) -> None:
        _need(self, "cube" in self.model.rest().observe().objects, 'an object "cube"')
        super().check_model()

    def observation_size(self) -> int:
        return 11

    def begin(self, episode: Episode, options: dict[str, Any]) -> None:
        given = options.get("pulled", self._random.uniform(0, 0.2, 2))
        episode.pulled = _within(given, "pulled", (2,), 0, 1)
        stood = np.array(episode.robot.observe().objects["cube"].position_m)
        episode.task["stood"], episode.task["place"], episode.task["speed"] = stood, stood, np.zeros(3)

    def observe(self, episode: Episode, seen: Observation) -> FloatArray:
        task = episode.task
        tensions = [cable.tension_N for cable in seen.cables.values()]
        left_s = max(0.0, self.table_goes_s - episode.steps * self.step_s)
        return _floats(100 * (task["place"] - task["stood"]), 10 * task["speed"], episode.pulled, tensions, left_s)

    def judge(self, episode: Episode, seen: Observation, action: FloatArray) -> tuple[float, bool, dict[str, Any]]:
        task = episode.task
        place = np.array(seen.objects["cube"].position_m)
        task["speed"], task["place"] = (place - task["place"]) / self.step_s, place
        away = float(np.linalg.norm(place - task["stood"]))
        info = {"away_m": away, "force_N": np.array(seen.objects["cube"].force_N)}
        if place[2] < task["stood"][2] - self.fallen_m:
            return -10.0, True, {**info, "is_success": False}
        held = episode.steps >= self.max_steps
        reward = -min(1.0, 100 * away) - 0.1 * float(np.mean(episode.pulled**2))
        return reward, False, {**info, "is_success": held}


class Crawl(_InTime):
    """A worm with a cable under its rear half and one under its front half crawls over a floor with friction; a motion
    in time.

    The worm has no supports. It stands on three feet; weights make its ends heavier than its middle.

    Observation (8,): heights of tail, middle and head over the floor, velocities along x of the same, in cm and dm/s;
    pull of each cable, 0 to 1 (2). Action (2,): change of the pull of each cable in 20 ms. Reward: motion of the middle
    along x in this step, cm.
    """

    max_steps: ClassVar[int] = 100
    option_names: ClassVar[tuple[str, ...] | None] = ()
    task_shapes: ClassVar[Mapping[str, tuple[int, ...]]] = {"places": (3, 3), "speeds": (3,)}
    largest_change: ClassVar[float] = 0.25

    @classmethod
    def make_model(cls, friction: float = 0.5, size_mm: float = 6.0) -> Model:
        worm = [
            {"box": [[0, -6, 2], [90, 6, 8]]},
            *({"box": [[x, -6, 0], [x + 6, 6, 3]]} for x in (0, 42, 84)),
        ]
        eyelet = "2 mm"
        return Model(
            Robot(
                name="worm",
                length_unit="mm",
                material={"soft": {"youngs_modulus": "0.3 MPa", "poisson_ratio": 0.4, "density": "1070 kg/m^3"}},
                mesh={"order": 1, "size": f"{size_mm} mm"},
                body=[{"name": "worm", "material": "soft", "geometry": {"union": worm}}],
                mass=[
                    {"name": "tail", "point": [3, 0, 5], "mass": "6 g"},
                    {"name": "head", "point": [87, 0, 5], "mass": "6 g"},
                ],
                marker=[
                    {"name": "tail", "point": [3, 0, 0]},
                    {"name": "middle", "point": [45, 0, 5]},
                    {"name": "head", "point": [87, 0, 0]},
                ],
                cable=[
                    {
                        "name": name,
                        "points": [[x, 0, 3] for x in places],
                        "eyelet_radius": eyelet,
                        "target": {"shortening": "4 mm"},
                    }
                    for name, places in (("rear", (4, 14, 24, 34, 43)), ("front", (47, 56, 66, 76, 86)))
                ],
                obstacle=[
                    {"name": "floor", "plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}, "friction": friction}
                ],
                contact={"self": False, "distance": "0.2 mm"},
                program={
                    "duration": "10 s",
                    "time_step": "20 ms",
                    "gravity": [0, 0, -9.81],
                    "stiffness_damping": 0.002,
                },
            )
        )

    def check_model(self) -> None:
        count = len(self.model.markers)
        if count != 3:
            raise InputError(f"Crawl needs 3 markers; the robot {self.model.robot.name!r} has {count}")
        super().check_model()

    def observation_size(self) -> int:
        return 8

    def begin(self, episode: Episode, options: dict[str, Any]) -> None:
        episode.task["places"] = episode.robot.markers()
        episode.task["speeds"] = np.zeros(3)

    def observe(self, episode: Episode, seen: Observation) -> FloatArray:
        return _floats(100 * episode.task["places"][:, 2], 10 * episode.task["speeds"], episode.pulled)

    def judge(self, episode: Episode, seen: Observation, action: FloatArray) -> tuple[float, bool, dict[str, Any]]:
        places = np.array([seen.markers[name] for name in self.model.markers])
        moved = (places - episode.task["places"])[:, 0]
        episode.task["places"], episode.task["speeds"] = places, moved / self.step_s
        return 100 * float(moved[1]), False, {"way_m": float(places[1, 0]) - 0.045}
