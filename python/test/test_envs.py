"""Environments: the signatures of Gymnasium, seeds, states that are kept and set, many at once."""

import copy
import os
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from robots import block

import pliant
from pliant.envs import Crawl, Follow, Grasp, Reach, RobotEnv, Vector

TASKS = [Reach, Follow, Grasp, Crawl]


@pytest.fixture(scope="module", params=TASKS, ids=lambda task: task.__name__)
def env(request):
    return request.param()


def played(env, seed, steps=6):
    """Everything that comes out of some steps."""
    random = np.random.default_rng(5)
    out = [env.reset(seed=seed)[0]]
    for _ in range(steps):
        observation, reward, terminated, truncated, info = env.step(random.uniform(-0.2, 1, env.action_space.shape))
        out += [observation, reward, terminated, truncated]
    return out


def same(a, b):
    return all(np.array_equal(x, y) for x, y in zip(a, b, strict=True))


def test_signatures_are_those_of_gymnasium(env):
    observation, info = env.reset(seed=3)
    assert observation.dtype == np.float32 and observation.shape == env.observation_space.shape
    assert env.observation_space.contains(observation) and isinstance(info, dict)
    assert env.action_space.shape == (len(env.model.actuators),)
    observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
    assert env.observation_space.contains(observation) and isinstance(reward, float) and isinstance(info, dict)
    assert type(terminated) is bool and type(truncated) is bool and "failed" not in info
    assert env.unwrapped is env and env.render() is None


def test_the_same_seed_gives_the_same_bits(env):
    first = played(env, 7)
    assert same(first, played(env, 7))
    assert same(first, played(type(env)(env.model), 7))
    assert not same(first, played(env, 8)) or isinstance(env, Crawl)  # which has nothing random


def test_a_state_can_be_saved_and_restored(env):
    played(env, 4, 3)
    action = np.full(env.action_space.shape, 0.4)
    kept = env.get_state()
    first = [env.step(action)[0] for _ in range(2)] + [env.reset()[0]]
    for again in (kept, copy.deepcopy(kept), pickle.loads(pickle.dumps(kept))):
        other = type(env)(env.model)
        other.reset(seed=99)
        other.set_state(again)
        assert same(first, [other.step(action)[0] for _ in range(2)] + [other.reset()[0]])


def test_vector_environments_equal_single_ones(env):
    task, count = type(env), 3
    many = Vector(task, count, model=env.model)
    random = np.random.default_rng(2)
    actions = random.uniform(-0.2, 1, (4, count, *env.action_space.shape))
    observations, infos = many.reset(seed=10)
    assert observations.shape == (count, *env.observation_space.shape) and infos["steps"].tolist() == [0, 0, 0]
    together = [observations] + [many.step(a) for a in actions]
    for k in range(count):
        alone = task(env.model)
        assert np.array_equal(alone.reset(seed=10 + k)[0], together[0][k])
        for a, (observed, rewards, terminated, truncated, _) in zip(actions, together[1:]):
            observation, reward, *_ = alone.step(a[k])
            assert np.array_equal(observation, observed[k]) and reward == rewards[k]
            assert not terminated[k] and not truncated[k]


def test_a_finished_episode_is_reset():
    class Short(Reach):
        max_steps = 2

    many = Vector(Short, 2)
    many.reset(seed=0)
    many.step(np.zeros((2, 3)))
    observations, _, terminated, truncated, infos = many.step(np.zeros((2, 3)))
    assert truncated.all() and not terminated.any()
    assert infos["_final_observation"].all() and infos["final_info"][0]["steps"] == 2
    assert not np.array_equal(infos["final_observation"][0], observations[0])
    assert infos["steps"].tolist() == [0, 0]


def test_infos_of_many_environments_are_arrays_of_their_own_kind():
    class Told(Reach):
        def _info(self, seen):
            return {**super()._info(seen), "text": "a", "mixed": True if self is many.envs[0] else 1.5}

    many = Vector(Told, 3)
    many.reset(seed=0)
    infos = many.step(np.zeros((3, 3)))[4]
    kinds = {"steps": np.int64, "distance_m": np.float64, "is_success": np.bool_, "text": object, "mixed": object}
    for key, kind in kinds.items():
        assert infos[key].dtype == kind and infos["_" + key].dtype == np.bool_, key
    assert (~infos["is_success"]).all() and np.isfinite(np.log(infos["distance_m"])).all()
    many.envs[1].max_steps = 2
    infos = many.step(np.zeros((3, 3)))[4]
    assert infos["distance_m"].dtype == np.float64 and infos["_distance_m"].tolist() == [True, False, True]
    assert infos["is_success"].dtype == np.bool_ and infos["distance_m"][1] == 0


def test_the_goal_of_reach_ends_the_episode():
    env = Reach()
    wanted = env.model.solve(env._inputs_at(np.array([0.3, 0, 0.15]), 0.0)).markers()[0]
    env.reset(seed=0, options={"goal": wanted})
    env.step([1, 0, 0.5])
    observation, reward, terminated, truncated, info = env.step([1, 0, 0.5])
    assert terminated and not truncated and info["is_success"] and reward > 0.9
    assert np.abs(observation[3:6]).max() < 1e-3


def test_a_gripped_cube_is_held_and_a_released_one_falls():
    env = Grasp()
    for pull in (0.3, -1.0):
        env.reset(seed=0, options={"pulled": [0, 0]})
        for step in range(env.max_steps):
            *_, reward, terminated, truncated, info = env.step([pull, pull])
            if terminated or truncated:
                break
        assert "failed" not in info
        if pull > 0:  # held by friction alone, as the force of all that touches it says
            assert truncated and info["is_success"] and info["away_m"] < 0.003
            assert info["force_N"] == pytest.approx([0, 0, 8e-3 * 9.81], abs=2e-3)
            assert np.abs(env.episode.robot.observe().contacts["table"]).max() == 0
        else:
            assert terminated and reward == -10 and not info["is_success"] and step < 50


def wave(k):
    """An arch that runs from the tail to the head in 0.6 s."""
    phase = k % 30
    return [1 if phase < 10 else -1, 1 if 10 <= phase < 20 else -1]


def crawled(env, steps, action=wave):
    """m, of the middle, along and across."""
    env.reset(seed=0)
    begin = env.episode.robot.markers()
    total = sum(env.step(action(k))[1] for k in range(steps))
    gone = env.episode.robot.markers() - begin
    assert 100 * gone[1, 0] == pytest.approx(total, abs=1e-5)
    return gone.mean(axis=0)


def test_a_worm_moves_only_with_friction():
    class Longer(Crawl):
        max_steps = 1000

    env = Longer()
    way = crawled(env, 60)
    assert env.episode.robot.time == pytest.approx(1.2)
    assert env.episode.robot.observe().contacts["floor"][2] > 0.1
    assert way[0] > 0.002 and abs(way[1]) < 0.1 * way[0]
    # Without friction its centre stays where it is, and so it does where all cables go at once: the same both ways.
    smooth = crawled(Longer(Crawl.make_model(friction=0.0)), 60)
    assert abs(smooth[0]) < 0.02 * way[0]
    both = crawled(env, 60, lambda k: [1, 1] if k % 30 < 10 else [-1, -1])
    assert abs(both[0]) < 0.1 * way[0]


def test_invalid_calls_are_refused():
    env = Reach(TASKS[0].make_model())
    with pytest.raises(pliant.InputError, match="call reset"):
        env.step([0, 0, 0])
    env.reset(seed=0)
    wrong = {
        "action has shape": lambda: env.step([0, 0]),
        "not finite": lambda: env.step([np.nan, 0, 0]),
        "action must be an array of numbers": lambda: env.step("up"),
        "seed must be a whole number": lambda: env.reset(seed=1.5),
        "goal has shape": lambda: env.reset(options={"goal": 3}),
        "render_mode is None": lambda: Reach(env.model, render_mode="human"),
        "Reach needs a marker \"tip\"; the robot 'block' has none": lambda: Reach(block()),
        "Grasp needs an object \"cube\"; the robot 'block' has none": lambda: Grasp(block()),
        "Crawl needs 3 markers; the robot 'block' has 1": lambda: Crawl(block()),
        "count is 0": lambda: Vector(Reach, 0, model=env.model),
    }
    for text, call in wrong.items():
        with pytest.raises(pliant.InputError, match=text):
            call()
    with pytest.raises(TypeError, match="a class of environments"):
        Vector(env, 3)


def test_gymnasium_checks_our_environments():
    gymnasium = pytest.importorskip("gymnasium")
    from gymnasium.utils.env_checker import check_env

    for task in TASKS:
        env = gymnasium.make(f"pliant/{task.__name__}-v0")
        assert isinstance(env.unwrapped, RobotEnv)
        check_env(env.unwrapped, skip_render_check=True)


def test_environments_are_registered_if_gymnasium_is_installed(tmp_path):
    """On a stand-in with the names of Gymnasium 0.29 that the module uses."""
    package = tmp_path / "gymnasium"
    (package / "envs").mkdir(parents=True)
    (package / "__init__.py").write_text("from . import spaces\nclass Env:\n    pass\n")
    (package / "envs" / "__init__.py").write_text("")
    (package / "envs" / "registration.py").write_text(
        "registry = {}\ndef register(id, entry_point):\n    registry[id] = entry_point\n"
    )
    (package / "spaces.py").write_text(
        "class Box:\n    def __init__(self, low, high, shape, dtype):\n        self.shape = shape\n"
    )
    code = (
        "import gymnasium, pliant.envs\n"
        "from gymnasium.envs.registration import registry\n"
        "assert sorted(registry) == ['pliant/' + n + '-v0' for n in ('Crawl', 'Follow', 'Grasp', 'Reach')], registry\n"
        "env = pliant.envs.Reach()\n"
        "assert isinstance(env, gymnasium.Env) and isinstance(env.action_space, gymnasium.spaces.Box)\n"
        "assert registry['pliant/Reach-v0'] == 'pliant.envs:Reach' and env.action_space.shape == (3,)\n"
    )
    path = os.pathsep.join([str(tmp_path), str(Path(pliant.__file__).parents[1])])
    subprocess.run([sys.executable, "-c", code], check=True, env={**os.environ, "PYTHONPATH": path})


def test_a_box_is_sampled_within_its_bounds():
    from pliant.envs.spaces import OwnBox

    box = OwnBox([-1, 0], [1, np.inf])
    box.seed(3)
    first = [box.sample() for _ in range(50)]
    box.seed(3)
    assert same(first, [box.sample() for _ in range(50)])
    assert np.abs([f[0] for f in first]).max() <= 1 and first[0].dtype == np.float32
    assert box.contains(np.zeros(2, np.float32)) and [0.0, 1.0] in OwnBox([-1, 0], [1, 2], dtype=np.float64)
    assert not box.contains(np.array([2, 0], np.float32)) and not box.contains(np.zeros(3, np.float32))


def test_a_bad_action_changes_no_environment_of_a_vector():
    many = Vector(Reach, 3)
    many.reset(seed=1)
    many.step(np.full((3, 3), 0.3))
    before = pickle.dumps([(e.robot.bytes(), e.pulled.tolist(), e.steps) for e in many.get_states()])
    bad = np.full((3, 3), 0.3)
    bad[2, 1] = np.nan
    with pytest.raises(pliant.InputError, match="^environment 2: action has a number that is not finite"):
        many.step(bad)
    assert before == pickle.dumps([(e.robot.bytes(), e.pulled.tolist(), e.steps) for e in many.get_states()])


def test_seeds_may_be_of_any_size():
    env = Reach()
    for seed in (0, 2**31, 2**32 - 1, 2**100, np.int64(5)):
        first = env.reset(seed=seed)[0]
        assert np.array_equal(first, env.reset(seed=seed)[0])
    many = Vector(Reach, 2, model=env.model)
    many.reset(seed=2**31)
    assert np.array_equal(many.reset(seed=2**31 - 1)[0][1], env.reset(seed=2**31)[0])
    env.action_space.seed(2**40)
    for call in (lambda: env.reset(seed=-1), lambda: many.reset(seed=-1), lambda: many.reset(seed=[3, -1])):
        with pytest.raises(pliant.InputError, match="must be a whole number that is not negative, not -1$"):
            call()


def test_impossible_options_are_refused_and_leave_the_environment_as_it_was():
    reach, follow, grasp, crawl = Reach(), Follow(), Grasp(), Crawl()
    reach.reset(seed=1)
    before = reach.get_state()
    wrong = {
        "goal has a number that is not finite": lambda: reach.reset(seed=3, options={"goal": [np.nan, 0, 0]}),
        "there is no option 'gaol' of Reach; there are: goal$": lambda: reach.reset(options={"gaol": [0.09, 0, 0]}),
        "there are: angle, radius$": lambda: follow.reset(options={"goal": [0.09, 0, 0]}),
        r"goal is \[1e\+300, 0.0, 0.0\]; it must be from": lambda: reach.reset(options={"goal": [1e300, 0, 0]}),
        r"radius is 1e\+300; it must be from 0 to 0.1$": lambda: follow.reset(options={"radius": 1e300}),
        "radius must be a number, not 'x'$": lambda: follow.reset(options={"radius": "x"}),
        "radius is -1.0; it must be from 0 to 0.1$": lambda: follow.reset(options={"radius": -1}),
        "pulled has a number that is not finite": lambda: grasp.reset(options={"pulled": [np.inf, 0]}),
        r"pulled is \[0.0, 2.0\]; it must be from 0 to 1$": lambda: grasp.reset(options={"pulled": [0, 2]}),
        "there are: none$": lambda: crawl.reset(options={"pulled": [0, 0]}),
        "options must be a dict, not str": lambda: reach.reset(options="goal"),
    }
    for text, call in wrong.items():
        with pytest.raises(pliant.InputError, match=text):
            call()
    assert reach.get_state() == before

    class Own(Reach):
        option_names = None

    Own(reach.model).reset(seed=0, options={"mine": 3})


def test_a_state_of_another_environment_is_refused():
    reach = Reach()
    follow, grasp = Follow(reach.model), Grasp()
    for env in (reach, follow, grasp):
        env.reset(seed=0)
    with pytest.raises(pliant.InputError, match="^the state is one of Reach, not of Follow$"):
        follow.set_state(reach.get_state())

    class Other(Reach):
        @classmethod
        def make_model(cls):
            return pliant.Model(super().make_model().robot.changed({"mesh.size": "9 mm"}))

    other = Other()
    other.reset(seed=0)
    kept = other.get_state()
    kept.kind = "Reach"
    with pytest.raises(pliant.InputError, match="^the state is one of an environment with another robot$"):
        reach.set_state(kept)
    many = Vector(Reach, 2, model=reach.model)
    many.reset(seed=0)
    before = many.get_states()
    with pytest.raises(pliant.InputError):
        many.set_states([reach.get_state(), kept])
    assert many.get_states()[0].robot == before[0].robot and many.get_states()[0].pulled is not before[0].pulled
    assert np.array_equal(many.get_states()[0].task["goal"], before[0].task["goal"])


def test_a_refused_reset_leaves_the_random_generator_as_it_was():
    follow, grasp = Follow(), Grasp()
    for env, wrong in ((follow, {"radius": "x"}), (grasp, {"pulled": [1, 2, 3]})):
        env.reset(seed=1)
        kept = env.get_state()
        for seed in (None, 5):
            with pytest.raises(pliant.InputError):
                env.reset(seed=seed, options=wrong)
            assert env.get_state() == kept
        first = env.reset()[0]
        env.reset(seed=1)
        assert np.array_equal(env.reset()[0], first)


def test_states_of_environments_are_values(env):
    env.reset(seed=2)
    kept = env.get_state()
    assert kept == copy.deepcopy(kept) == pickle.loads(pickle.dumps(kept)) and not kept != env.get_state()
    env.step(np.full(env.action_space.shape, 0.4))
    assert kept != env.get_state() and kept != 3


def changed(state, **members):
    state = copy.deepcopy(state)
    for name, value in members.items():
        setattr(state, name, value)
    return state


def test_a_damaged_state_is_refused_and_leaves_the_environment_as_it_was():
    env = Follow()
    env.reset(seed=1)
    kept = env.get_state()
    wrong = {
        r"pulled of the state has shape \(7,\); it must have shape \(3,\)": {"pulled": np.zeros(7)},
        "pulled of the state must be from 0 to 1": {"pulled": np.array([0, 0, 2.0])},
        "pulled of the state must be an array of numbers, not None": {"pulled": None},
        "steps of the state is -1": {"steps": -1},
        "steps of the state must be a whole number": {"steps": 1.5},
        "task of the state must be a dict, not NoneType": {"task": None},
        "task of the state has no 'radius'": {"task": {"angle": 0.0}},
        r"task\['angle'\] of the state has shape \(2,\)": {"task": {**kept.task, "angle": [1, 2]}},
        r"task\['radius'\] of the state is 1e\+300; it must be": {"task": {**kept.task, "radius": 1e300}},
        "random of the state is not that of a random generator": {"random": {"bit_generator": "PCG64"}},
        "random of the state is not": {"random": 3},
    }
    for text, members in wrong.items():
        with pytest.raises(pliant.InputError, match="^" + text):
            env.set_state(changed(kept, **members))
        assert env.get_state() == kept
    with pytest.raises(TypeError, match="^the robot of the state must be a pliant.State, not None$"):
        env.set_state(changed(kept, robot=None))
    many = Vector(Follow, 2, model=env.model)
    many.reset(seed=0)
    before = many.get_states()
    with pytest.raises(pliant.InputError, match="^environment 1: pulled of the state has shape"):
        many.set_states([kept, changed(kept, pulled=np.zeros(7))])
    with pytest.raises(pliant.InputError, match="^episodes must be a list of pliant.Episode, not None$"):
        many.set_states(None)
    assert many.get_states() == before
    many.set_states(iter([kept, kept]))
    assert many.get_states() == [kept, kept]


def test_an_environment_whose_task_fails_does_not_change():
    class Picky(Reach):
        max_steps = 2
        fails = False

        def begin(self, episode, options):
            super().begin(episode, options)
            if Picky.fails and self._random.uniform() < 2:
                raise ValueError("no goal")

        def judge(self, episode, seen, action):
            episode.task["goal"] += 1
            if Picky.fails and episode.steps == 1:
                raise ValueError("no judge")
            return super().judge(episode, seen, action)

    env = Picky()
    many = Vector(Picky, 2, model=env.model)
    env.reset(seed=1)
    many.reset(seed=1)
    many.step(np.zeros((2, 3)))
    before = env.get_state(), many.get_states()
    Picky.fails = True
    for call in (lambda: env.step([0, 0, 0]), lambda: env.reset(seed=3), lambda: many.step(np.zeros((2, 3)))):
        with pytest.raises(ValueError, match="no (goal|judge)"):
            call()
    assert before == (env.get_state(), many.get_states())


def test_a_state_may_be_of_a_robot_with_other_constants():
    light, heavy = Grasp(), Grasp(Grasp.make_model(mass_g=20))
    light.reset(seed=0)
    heavy.set_state(light.get_state())
    assert heavy.get_state() == light.get_state() and heavy.episode.robot.model is heavy.model
    assert "failed" not in heavy.step([0, 0])[-1]
