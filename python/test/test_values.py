"""Values can be compared, copied and pickled, and their arrays are their own."""

import copy
import pickle

import numpy as np
import pytest
from robots import BAR, BLOCK, bar, cube

import pliant


GOAL = {"name": "reach", "marker": "tip", "plane": {"point": [0, 0, 8], "normal": [0, 0, 1]}, "tolerance": "1 mm"}


@pytest.fixture(scope="module")
def model():
    return bar(
        cable=[{**BAR["cable"][0], "range": ["0 mm", "8 mm"]}],
        goal=[GOAL],
    )


@pytest.fixture(scope="module")
def program(model):
    return model.run()


def both(value):
    """Copies of it by both ways."""
    return copy.deepcopy(value), pickle.loads(pickle.dumps(value))


def test_the_result_of_a_step_says_what_it_is_and_can_be_pickled(model):
    result = model.step(model.rest(), [0.058])
    assert "requested inputs" in type(result).arrived.__doc__ and "Result of a step" in type(result).__doc__
    assert repr(result).startswith("<pliant.StepResult: arrived, ") and f"{result.iterations} iterations" in repr(result)
    for again in both(result):
        assert again == result and again.residual == result.residual and type(again) is pliant.StepResult
    assert result != model.step(model.rest(), [0.055]) and result != 3


def test_inputs_do_not_change(model):
    inputs = model.program(0.5)
    for name in ("time", "names", "_values", "colour"):
        with pytest.raises(AttributeError, match=f"inputs do not change: {name} cannot be set"):
            setattr(inputs, name, 1)
    with pytest.raises(AttributeError, match="inputs do not change: time cannot be deleted"):
        del inputs.time
    assert inputs == model.program(0.5) and all(again == inputs for again in both(inputs))


def test_a_run_that_stopped_says_so_once(program):
    stopped = bar(program={"steps": 2, "max_iterations": 1}).run()
    assert f"steps, {stopped.message}>" in repr(stopped) and stopped.message.startswith("stopped at step")
    assert "stopped" not in repr(program)


def test_steps_and_waypoints_can_be_pickled_and_compared(model, program):
    for value in (program[-1], pliant.inverse(model)[0], program[1].observed, model.rest().fields()):
        for again in both(value):
            assert again == value and not again != value
    assert program[1] != program[2] and program[1].observed != program[2].observed
    assert np.array_equal(pickle.loads(pickle.dumps(program[2])).positions, program[2].positions)


def test_a_slice_of_a_result_is_a_list(model, program):
    assert program[:2] == [program[0], program[1]] and program[::-2] == list(program)[::-2] and program[9:] == []
    found = pliant.inverse(model)
    assert found[:1] == [found[0]] and found[1:] == []
    for result in (program, found):
        with pytest.raises(pliant.InputError, match="^index must be a whole number, not 1.5$"):
            result[1.5]


def test_inputs_are_equal_if_their_time_is_too(model):
    assert model.inputs(None, time=0.3) == model.inputs(None, time=0.3) != model.inputs(None, time=0.6)
    assert model.inputs([0.058]) != model.inputs([0.057]) and dict(model.inputs([0.058])) == model.inputs([0.058])


def test_what_lives_in_this_process_says_what_can_be_pickled(model, program):
    for value in (program, pliant.inverse(model), pliant.Batch(model, 1), model.linearise(model.rest())):
        with pytest.raises(TypeError, match=f"^a {type(value).__name__} cannot be pickled; pickle its "):
            pickle.dumps(value)
        assert copy.copy(value) is value and copy.deepcopy(value) is value


def test_a_reduced_model_can_be_pickled(model):
    reduced = pliant.reduce(model, samples=4)
    again = pickle.loads(pickle.dumps(reduced))
    assert np.array_equal(again.solve([0.057]).positions, reduced.solve([0.057]).positions)
    assert copy.deepcopy(reduced) is reduced
    with pytest.raises(TypeError, match="pickle its inputs"):
        pickle.dumps(reduced.start())
    kept = copy.copy(reduced.start())
    reduced.step(kept, [0.057])
    assert not np.array_equal(kept.positions, reduced.start().positions)


def test_equality_of_values_with_arrays_is_well_defined(model):
    state = model.solve([0.058])
    seen = state.observe()
    assert seen == state.observe() and seen != model.rest().observe() and seen != 3
    mesh = cube()
    assert mesh == cube() and mesh != pliant.Mesh(2 * mesh.points, mesh.tets) and mesh == pickle.loads(pickle.dumps(mesh))
    assert mesh != pliant.Mesh(mesh.points, mesh.tets, np.zeros(6, int))
    weights = {"tip": [0, 0, 1]}
    assert model.grad(state, markers=weights) == model.grad(state, markers=weights)
    assert pliant.Measure("marker", "tip", np.array([0, 0, 1])) == pliant.Measure("marker", "tip", np.array([0, 0, 1]))
    tips = [pliant.Measure("marker", "tip", d) for d in ((0, 0, 1), (0, 1, 0))]
    assert tips[0] != tips[1] and len(set(tips)) == 2
    with pytest.raises(TypeError):
        hash(seen)


def test_a_mesh_keeps_copies_of_its_arrays():
    points, tets = cube().points.copy(), cube().tets.copy()
    mesh = pliant.Mesh(points, tets, np.zeros(6, np.int32))
    points[:] = np.nan
    tets[:] = 0
    assert mesh == pliant.Mesh(cube().points, cube().tets, [0] * 6)
    assert pliant.Model(pliant.Robot(BLOCK), mesh).node_count == 8
    with pytest.raises(ValueError):
        mesh.points[0, 0] = 1
    for again in both(mesh):
        with pytest.raises(ValueError, match="read-only"):
            again.points[0, 0] = 1


def test_found_of_a_workspace_is_an_array_of_truth_values(model):
    space = pliant.workspace(model, side=2, between=0)
    assert space.found.dtype == np.bool_ and space.values[space.found].shape == (2, 1)
