"""Robots, models, states and steps: what goes in, what comes out, and what is kept."""

import copy
import json
import os
import pickle
import subprocess
import threading
import time

import numpy as np
import pytest
from robots import BAR, BLOCK, bar, block, cube

import pliant

FINGER = "examples/tutorial/finger.toml"


@pytest.fixture(scope="module")
def model():
    return bar()


def pulled(model, shortening="2 mm"):
    state = model.rest()
    assert model.step(state, {"flexor": {"shortening": shortening}}).arrived
    return state


def test_a_robot_from_a_file_from_text_and_from_a_dict_is_the_same(tmp_path):
    robot = pliant.Robot(BAR)
    file = tmp_path / "bar.toml"
    file.write_text(robot.text)
    states = [pulled(pliant.Model(r)) for r in (robot, pliant.Robot.load(file), pliant.Robot.parse(robot.text))]
    assert states[0].bytes() == states[1].bytes() == states[2].bytes()
    assert (robot.name, robot.steps, robot.duration) == ("bar", 4, 1)


def test_a_robot_is_changed_by_keys():
    robot = pliant.Robot(BAR).changed({"program.steps": 7, "name": "other"})
    assert (robot.steps, robot.name) == (7, "other")
    assert pliant.Robot.load(FINGER, ["program.steps=3"]).steps == 3
    assert pickle.loads(pickle.dumps(robot)).steps == 7


def test_arrays_are_views_that_cannot_be_written(model):
    state = pulled(model)
    for array in (model.rest_positions, model.tets, model.regions, state.positions):
        assert not array.flags.owndata and not array.flags.writeable
        with pytest.raises(ValueError):
            array[0] = 0
    assert np.shares_memory(state.positions, state.positions)
    assert state.positions.shape == (model.node_count, 3) == model.rest_positions.shape
    assert model.tets.shape == (model.tet_count, 4)
    before = state.positions
    kept = before.copy()
    model.step(state, {"flexor": {"shortening": "3 mm"}})
    assert np.array_equal(before, kept) and not np.array_equal(before, state.positions)


def test_arrays_outlive_their_model_and_state():
    array = block().rest_positions
    state = block().rest()
    positions = state.positions
    del state
    assert array.sum() == positions.sum() == pytest.approx(0.12)


def test_the_surface_encloses_the_volume(model):
    a, b, c = (model.rest_positions[model.surface()[:, k]] for k in range(3))
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6 == pytest.approx(6e-6, rel=1e-9)


def test_controls_may_be_given_in_many_equal_ways(model):
    rest = model.rest().inputs["flexor"].value
    same = [
        {"flexor": {"shortening": "2 mm"}},
        {"flexor": {"shortening": 0.002}},
        {"flexor": {"length": "58 mm"}},
        {"flexor": {"length": rest - 0.002}},
        {"flexor": {"length_ratio": 58 / 60}},
        {"flexor": pliant.Drive("length", rest - 0.002)},
        [rest - 0.002],
        np.array([rest - 0.002]),
        np.array([rest - 0.002], dtype=np.longdouble),
    ]
    for controls in same:
        inputs = model.inputs(controls)
        assert inputs["flexor"].by == "length"
        assert inputs["flexor"].value == pytest.approx(0.058, rel=1e-12)
    assert model.inputs({"flexor": {"tension": "2 N"}})["flexor"] == ("tension", 2.0)
    assert list(model.inputs(None)) == ["flexor"]
    assert model.inputs(same[0], time=0.5).time == 0.5


def test_chambers_are_driven_by_the_keys_of_the_robot_file():
    table = {
        **BAR,
        "chamber": [{"name": "air", "geometry": {"box": [[10, 3, 3], [50, 7, 6]]}, "target": {"pressure": "5 kPa"}}],
        "mesh": {"order": 1, "size": "3 mm"},
    }
    model = pliant.Model(pliant.Robot(table))
    assert model.actuators == ("flexor", "air")
    volume = model.rest().observe().chambers["air"].volume_m3
    assert volume == pytest.approx(40 * 4 * 3 * 1e-9, rel=1e-9)
    wanted = {
        "pressure": ("4 kPa", "pressure", 4000),
        "volume_ratio": (1.1, "volume", 1.1 * volume),
        "volume_change": ("20 mm^3", "volume", volume + 20e-9),
    }
    for kind, (value, by, number) in wanted.items():
        drive = model.inputs({"air": {kind: value}})["air"]
        assert drive.by == by and drive.value == pytest.approx(number, rel=1e-12)
    state = model.rest()
    model.step(state, {"air": {"pressure": "2 kPa"}})
    seen = state.observe().chambers["air"]
    assert seen.pressure_Pa == pytest.approx(2000) and seen.volume_ratio > 1
    assert state.observe().cables["flexor"].length_ratio == pytest.approx(1, abs=1e-6)


def test_step_changes_the_state_and_solve_does_not(model):
    state = model.rest()
    rest = state.copy()
    found = model.solve({"flexor": {"shortening": "2 mm"}}, state=state)
    assert state == rest and found != rest
    result = model.step(state, {"flexor": {"shortening": "2 mm"}})
    assert result.arrived and result.iterations > 0 and 0 < result.residual < 1e-4
    assert state == found
    assert state.observe().cables["flexor"].length_m == pytest.approx(0.058, rel=1e-6)
    assert np.allclose(state.markers()[0], state.observe().markers["tip"])
    with pytest.raises(pliant.Failure, match="iteration"):
        pliant.Model(model.robot, iteration_limit=1).solve({"flexor": {"shortening": "20 mm"}})


def test_states_are_copied_saved_and_pickled(model, tmp_path):
    state = pulled(model)
    copies = [state.copy(), copy.copy(state), copy.deepcopy(state), model.state_from(state.bytes())]
    state.save(tmp_path / "state")
    copies.append(model.load_state(tmp_path / "state"))
    for other in copies:
        assert other == state
        model.step(other, {"flexor": {"shortening": "3 mm"}})
        assert other != state
    assert all(other == copies[0] for other in copies)
    again, same_model = pickle.loads(pickle.dumps((state, state.model)))
    assert again.model is same_model
    assert again.bytes() == state.bytes()
    same_model.step(again, {"flexor": {"shortening": "3 mm"}})
    assert again.bytes() == copies[0].bytes()


def test_a_pickled_model_keeps_its_mesh_and_tolerance():
    model = pliant.Model(pliant.Robot(BLOCK), cube(), tolerance=1e-8)
    again = pickle.loads(pickle.dumps(model))
    state = again.rest()
    assert again.step(state, {"side": {"length_ratio": 0.95}}).residual < 1e-8


def test_a_mesh_from_arrays_carries_a_load():
    model = block()
    assert (model.node_count, model.tet_count, model.order) == (8, 6, 1)
    state = model.solve({"side": {"tension": 0}}, time=1)
    assert state.observe().supports["bottom"][2] == pytest.approx(0.1, rel=1e-3)
    assert state.observe().markers["top"][2] < 0.01
    state = model.solve(model.program(1))
    assert state.observe().cables["side"].length_ratio == pytest.approx(0.9, rel=1e-6)


def test_fields_have_a_value_for_each_tet(model):
    fields = pulled(model).fields()
    assert fields.volume_ratio.shape == fields.von_mises_Pa.shape == (model.tet_count,)
    assert np.allclose(fields.volume_ratio, 1, atol=0.1) and fields.von_mises_Pa.max() > 1e3
    assert fields.max_stretch.max() > 1 and fields.energy_density_Pa.min() >= 0


def test_cable_paths_have_the_length_of_their_cables(model):
    state = pulled(model)
    path = model.cable_paths(state)["flexor"]
    length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    assert length == pytest.approx(state.observe().cables["flexor"].length_m, rel=1e-12)


def test_dynamics_advance_with_time_and_not_back():
    model = bar(program={"duration": "0.2 s", "time_step": "0.01 s", "gravity": [0, 0, -9.81]})
    state = model.rest()
    for k in range(1, 3):
        assert model.step(state, time=0.01 * k).arrived
        assert state.velocities[:, 2].min() < -0.03
        assert state.observe().kinetic_energy_J > 0
    assert state.time == pytest.approx(0.02) and state.displacements[:, 2].min() < -5e-4
    with pytest.raises(pliant.InputError, match="does not lead on"):
        model.step(state, time=0.01)
    with pytest.raises(pliant.InputError, match="take several calls"):
        model.step(state, time=1e6)


def test_one_call_takes_the_time_steps_of_the_program():
    model = bar(program={"duration": "0.2 s", "time_step": "0.01 s", "gravity": [0, 0, -9.81]})
    at_once, by_steps = model.rest(), model.rest()
    result = model.step(at_once, time=0.055)
    assert result.arrived and result.pieces == 6
    for k in range(1, 7):
        assert model.step(by_steps, time=0.055 * k / 6).pieces == 1
    assert np.abs(at_once.displacements).max() > 1e-4
    assert np.allclose(at_once.positions, by_steps.positions, rtol=0, atol=1e-7)


def test_a_run_gives_the_same_bits_as_the_command_line(tmp_path):
    program = os.environ["PLIANT_PROGRAM"]
    out = tmp_path / "out"
    subprocess.run(
        [program, "simulate", FINGER, "--steps", "3", "--pictures", "none", "-q", "-o", str(out)], check=True
    )
    result = pliant.Model(pliant.Robot.load(FINGER, {"program.steps": 3})).run()
    assert result.converged and len(result) == 4
    told = json.loads((out / "summary.json").read_text())
    for step, own, ours in zip(told["steps"], result.summary["steps"], list(result)[1:]):
        for timed in (step, own):
            timed.pop("wall_ms")
        assert step == own
        for name, place in ours.observed.markers.items():
            assert step["markers"][name] == (1e3 * place).tolist()
        for name, cable in ours.observed.cables.items():
            assert step["cables"][name]["tension_N"] == cable.tension_N
    assert result.positions.shape == (4, result.model.node_count, 3)
    assert np.array_equal(result.positions[-1], result[-1].positions)
    assert result.markers["tip"].shape == (4, 3) and result.times.tolist() == pytest.approx([0, 1 / 3, 2 / 3, 1])


def test_a_program_writes_its_results_and_reports_its_steps(tmp_path):
    seen = []
    result = bar().run(on_step=lambda step: seen.append(step.index))
    assert seen == [0, 1, 2, 3, 4]
    result.write(tmp_path / "out", pictures="none")
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["converged"]
    with pytest.raises(IndexError):
        result[5]
    with pytest.raises(pliant.InputError, match="pictures is none, few or all, not 'many'"):
        result.write(tmp_path / "out", pictures="many")


def test_a_program_resumes_from_its_checkpoint(tmp_path):
    model = bar()
    whole = model.run()

    def stop(step):
        if step.index == 2:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        model.run(checkpoint=tmp_path / "kept", on_step=stop)
    resumed = model.run(checkpoint=tmp_path / "kept", resume=True)
    assert resumed.converged and np.array_equal(resumed[-1].positions, whole[-1].positions)
    resumed.remove_checkpoint()


def test_a_state_can_be_read_while_another_thread_steps_it(tmp_path):
    model = block()
    state, rest = model.rest(), model.rest().inputs.values_SI
    until, failed = time.monotonic() + 1, []

    def read():
        try:
            while time.monotonic() < until:
                model.jacobian(state)
                state == state.copy()
                state.save(tmp_path / f"{threading.get_ident()}.state")
        except BaseException as error:
            failed.append(error)

    readers = [threading.Thread(target=read) for _ in range(2)]
    for reader in readers:
        reader.start()
    k = 0
    while time.monotonic() < until:
        k += 1
        model.step(state, rest * (0.9 + 0.01 * (k % 9)))
    for reader in readers:
        reader.join()
    assert not failed


def test_a_step_that_needs_no_iteration_gives_the_same_state_whatever_was_solved_before():
    model = block()
    lengths = model.rest().inputs.values_SI
    first, later = model.rest(), model.rest()
    assert model.step(first, lengths).iterations == 0
    model.solve(0.9 * lengths)
    assert model.step(later, lengths).iterations == 0
    assert first == later and first.bytes() == later.bytes()


def test_threads_share_a_model_and_get_the_same_bits(model):
    alone = pulled(model)
    found = []
    threads = [threading.Thread(target=lambda: found.append(pulled(model))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4 and all(state == alone for state in found)


def test_joints_and_sensors_are_observed_by_name():
    robot = pliant.Robot.load("examples/crank_and_rod/robot.toml")
    seen = []
    result = pliant.Model(robot).run(on_step=lambda step: seen.append(step.observed))
    assert result.converged
    motor, pin = seen[-1].joints["motor"], seen[-1].joints["crank pin"]
    assert list(seen[0].joints) == ["tip pin", "crank pin", "motor"]
    assert seen[0].joints["motor"].coordinate == pytest.approx(0, abs=1e-12)
    assert motor.coordinate == pytest.approx(np.radians(150), rel=1e-4)
    assert motor.effort > 0 and pin.effort == 0
    # The crank has no other forces on it than those of its two pins, the motor's and that of the rod.
    assert motor.force_N == pytest.approx(-pin.force_N, abs=1e-3 * np.linalg.norm(pin.force_N))

    sensed = {**BAR, "sensor": [{"name": "pull", "kind": "tension", "cable": "flexor"}]}
    model = pliant.Model(pliant.Robot(sensed))
    observed = pulled(model).observe()
    assert observed.sensors == {"pull": {"tension": observed.cables["flexor"].tension_N}}
