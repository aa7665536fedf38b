"""Many robots at once."""

import threading

import numpy as np
import pytest
from robots import BAR, bar, block

import pliant


@pytest.fixture(scope="module")
def model():
    return bar()


def lengths(robots):
    return 0.06 - 1e-4 * np.arange(1, robots + 1)[:, None]


def test_a_batch_gives_the_same_bits_as_robots_solved_one_by_one(model):
    robots = 12
    one_by_one = []
    for controls in lengths(robots):
        state = model.rest()
        for share in (0.5, 1):
            model.step(state, 0.06 + share * (controls - 0.06))
        one_by_one.append(state)
    for threads in (1, 2, 5):
        batch = pliant.Batch(model, robots, threads=threads)
        assert len(batch) == robots and batch.threads == threads
        states = batch.rest()
        for share in (0.5, 1):
            results = batch.step(states, 0.06 + share * (lengths(robots) - 0.06))
            assert all(result.arrived for result in results)
        assert states == one_by_one
    seen = batch.observe(states)
    assert seen[3].markers["tip"].tolist() == states[3].observe().markers["tip"].tolist()


def test_robots_of_a_batch_may_differ(model):
    other = block()
    batch = pliant.Batch([model, other])
    states = batch.rest()
    batch.step(states, [{"flexor": {"shortening": "1 mm"}}, {"side": {"length_ratio": 0.95}}])
    assert states[0] == model.solve({"flexor": {"shortening": "1 mm"}})
    assert states[1] == other.solve({"side": {"length_ratio": 0.95}})
    batch.step(states)
    assert states[1].observe().cables["side"].length_ratio == pytest.approx(0.95, rel=1e-6)


def test_mistakes_name_the_robot_and_do_not_change_the_states(model):
    batch = pliant.Batch(model, 3)
    states = batch.rest()
    mistakes = {
        "robot 1: controls has shape (2,); it must have shape (1,)": lambda: batch.step(states, [[0.05], [1, 2], [0.05]]),
        "robot 2: cable \"flexor\": nan": lambda: None,
        "2 controls for 3 robots": lambda: batch.step(states, [[0.05]] * 2),
        "2 states for 3 robots": lambda: batch.step(states[:2]),
        "states must be a list of pliant.State, not None": lambda: batch.step(None),
        "controls must be a list with one entry for each of 3 robots": lambda: batch.step(states, np.array(0.05)),
        "controls must be a list": lambda: batch.step(states, {"flexor": {"shortening": "1 mm"}}),
        "the same state is given for two robots": lambda: batch.step([states[0]] * 3),
        "robot 0: the state is one of another model": lambda: batch.step([block().rest(), *states[1:]]),
        "count goes with one model": lambda: pliant.Batch([model], 2),
        "the number of threads is negative": lambda: pliant.Batch(model, 2, threads=-1),
    }
    del mistakes["robot 2: cable \"flexor\": nan"]
    for text, call in mistakes.items():
        with pytest.raises(pliant.InputError) as caught:
            call()
        assert str(caught.value).startswith(text)
    with pytest.raises(pliant.InputError, match="^robot 1: .*not finite"):
        batch.step(states, np.array([[0.05], [np.nan], [0.05]]))
    assert states == batch.rest()


def test_states_and_controls_may_be_iterated_over_once(model):
    batch = pliant.Batch(model, 2)
    states = batch.rest()
    batch.step(iter(states), iter(lengths(2)))
    again = batch.rest()
    batch.step(again, lengths(2))
    assert states == again and batch.observe(iter(states)) == batch.observe(again)
    with pytest.raises(TypeError, match="^each of states must be a pliant.State, not int$"):
        batch.step([states[0], 3])


def test_an_empty_batch_does_nothing(model):
    batch = pliant.Batch(model, 0)
    assert batch.step(batch.rest()) == []


def test_progress_can_cancel_a_batch_but_not_call_it(model):
    batch = pliant.Batch(model, 4)
    states = batch.rest()
    with pytest.raises(pliant.Cancelled):
        batch.step(states, lengths(4), progress=lambda stage, share: False)
    with pytest.raises(pliant.InputError, match="at work"):
        batch.step(states, lengths(4), progress=lambda stage, share: batch.observe(states))
    assert all(result.arrived for result in batch.step(states, lengths(4)))


def test_threads_take_turns_with_one_batch(model):
    batch = pliant.Batch(model, 4)
    found = []

    def work():
        states = batch.rest()
        batch.step(states, lengths(4))
        found.append(states)

    threads = [threading.Thread(target=work) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 3 and found[0] == found[1] == found[2]


def test_options_of_a_model_hold_for_everything_that_is_done_with_it():
    robot = bar(cable=[{**BAR["cable"][0], "range": ["0 mm", "8 mm"]}]).robot
    tight = pliant.Model(robot, tolerance=1e-9)
    loose = pliant.Model(robot)
    state = tight.rest()
    assert tight.step(state, [0.057]).residual < 1e-9 < loose.step(loose.rest(), [0.057]).residual
    states = pliant.Batch(tight, 2).rest()
    pliant.Batch(tight, 2).step(states, [[0.057]] * 2)
    assert states == [state, state]
    assert tight.run()[-1].result.residual < 1e-9 < loose.run()[-1].result.residual
    tension = pliant.Measure("tension", "flexor")
    found = [pliant.gradient(m, [tension], lambda k, v: (v[0], [1.0])).values[-1, 0] for m in (tight, loose)]
    end = tight.run()[-1].observed.cables["flexor"].tension_N
    assert found[0] == pytest.approx(end, rel=1e-9) and found[1] != found[0]
    reduced = pliant.reduce(tight, samples=4)
    exact = reduced.exact(reduced.solve([0.057]))
    assert np.abs(exact.positions - state.positions).max() < 1e-8
    assert len(pliant.workspace(tight, side=2, between=0)) == len(pliant.workspace(loose, side=2, between=0))
    one = pliant.Model(robot, iteration_limit=1)
    assert not one.run().converged
    assert not pliant.Batch(one, 1).step(pliant.Batch(one, 1).rest(), [{"flexor": {"shortening": "20 mm"}}])[0].arrived
    assert not pliant.workspace(one, side=2, between=0).found.all()
