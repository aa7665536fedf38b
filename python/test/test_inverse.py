"""Goals, workspaces, identification, gradients of programs."""

import json
import os
import subprocess

import numpy as np
import pytest
from robots import BAR, bar

import pliant

CABLE = {**BAR["cable"][0], "range": ["0 mm", "8 mm"]}
PLANE = {"point": [0, 0, 8], "normal": [0, 0, 1]}
REACHING = {
    **BAR,
    "cable": [CABLE],
    "goal": [{"name": "reach", "marker": "tip", "plane": PLANE, "tolerance": "0.01 mm"}],
}


@pytest.fixture(scope="module")
def model():
    return pliant.Model(pliant.Robot(REACHING))


def test_a_goal_is_reached_as_on_the_command_line(model, tmp_path):
    result = pliant.inverse(model)
    assert result.reached and len(result) == result.waypoints_wanted == 1 and not result.message
    (flexor,) = result.inputs
    assert (flexor.name, flexor.unit, flexor.high) == ("flexor", "m", pytest.approx(0.008))
    waypoint = result[0]
    goal = waypoint.goals[0]
    assert goal.reached and goal.unit == "m" and goal.error < 1e-5 and goal.got[0][2] == pytest.approx(0.008, abs=1e-5)
    state = model.solve({"flexor": {"shortening": waypoint.inputs["flexor"]}})
    assert state.markers()[0] == pytest.approx(waypoint.observed.markers["tip"], abs=1e-5)
    assert result.inputs_at(0) == result.inputs_at(-1)
    assert model.solve(result.inputs_at(0)).markers() == pytest.approx(state.markers(), abs=1e-9)
    with pytest.raises(IndexError, match="there is no waypoint 1; there are 1"):
        result.inputs_at(1)
    assert waypoint.positions.shape == (model.node_count, 3) and waypoint.result.arrived
    assert "reach" in result.text or "reached" in result.text

    file = tmp_path / "bar.toml"
    file.write_text(model.robot.text)
    run = [os.environ["PLIANT_PROGRAM"], "inverse", str(file), "--json"]
    told = json.loads(subprocess.run(run, check=True, capture_output=True, text=True).stdout)
    own = pliant.inverse(pliant.Model(pliant.Robot.load(file))).summary
    assert untimed(told) == untimed(own)
    result.write(tmp_path / "out")
    assert (tmp_path / "out" / "program.toml").exists()


def untimed(value):
    if isinstance(value, dict):
        return {k: untimed(v) for k, v in value.items() if "wall" not in k and "timing" not in k and "memory" not in k}
    return [untimed(v) for v in value] if isinstance(value, list) else value


def test_an_unreachable_goal_names_its_limit():
    far = {**REACHING["goal"][0], "plane": {"point": [0, 0, 80], "normal": [0, 0, 1]}}
    result = pliant.inverse(pliant.Model(pliant.Robot({**REACHING, "goal": [far]})))
    assert not result.reached and not result[0].reached and "flexor" in result[0].limits[0]
    with pytest.raises(pliant.InputError):
        pliant.inverse(bar())


def test_a_goal_beside_all_that_the_actuators_do_says_so(model):
    beside = 1e3 * model.solve({"flexor": {"shortening": "4 mm"}}).markers()[0] + [0, 10, 0]
    goal = {"name": "reach", "marker": "tip", "point": beside.tolist()}
    result = pliant.inverse(pliant.Model(pliant.Robot({**REACHING, "goal": [goal]})))
    assert result[0].limits == ["no small change of the inputs brings it nearer"]
    assert result.summary["waypoints"][0]["reasons"] == result[0].limits


def test_a_workspace_is_sampled(model, tmp_path):
    space = pliant.workspace(model, side=3, between=5)
    assert len(space) == len(space.values) > 0 and space.values.shape[1] == 1
    reached = space.found > 0
    assert space.markers.shape == (len(space), 1, 3) and np.isfinite(space.markers[reached]).all()
    assert space.tensions.shape == (len(space), 1) and space.pressures.shape == (len(space), 0)
    pull = space.values[reached, 0]
    assert pull.min() >= 0 and pull.max() <= 0.008 + 1e-12
    k = int(np.argmax(np.where(reached, space.values[:, 0], -1)))
    state = model.solve({"flexor": {"shortening": space.values[k, 0]}})
    assert space.markers[k, 0] == pytest.approx(state.markers()[0], abs=2e-6)
    assert model.solve(space.inputs_at(k)).markers()[0] == pytest.approx(space.markers[k, 0], abs=2e-6)
    assert space.message == "" and space.warnings == []
    assert space.sheets("tip")[0].shape[1] == 3
    with pytest.raises(pliant.InputError, match="there is no marker 'top'; there are tip"):
        space.sheets("top")
    space.write(tmp_path / "out")
    assert (tmp_path / "out" / "workspace.json").exists()


def measured(model):
    table = "step,tip_z_mm,flexor_tension_N\n"
    for step in list(model.run())[1:]:
        seen = step.observed
        table += f"{step.index},{1e3 * seen.markers['tip'][2]:.12g},{seen.cables['flexor'].tension_N:.12g}\n"
    return table


def test_a_modulus_is_identified_from_simulated_measurements(tmp_path):
    table = measured(bar())
    other = pliant.Robot(BAR).changed({"material.soft.youngs_modulus": "0.7 MPa"})
    found = pliant.identify(other, "material.soft.youngs_modulus", table, judge="every_second")
    (modulus,) = found.estimates
    assert found.converged and modulus.value == pytest.approx(1e6, rel=1e-4) and modulus.start == pytest.approx(0.7e6)
    (tension,) = (e for e in found.judged if e.unit == "N")  # positions hardly depend on it
    assert len(found.comparisons) == 8 and tension.values == 2 and tension.after < 0.01 * tension.before
    assert measured(pliant.Model(found.robot)).split("\n")[-2][:6] == table.split("\n")[-2][:6]
    file = tmp_path / "bar.csv"
    file.write_text(table)
    again = pliant.identify(other, ["material.soft.youngs_modulus"], file, judge="every_second")
    assert again.estimates == found.estimates
    with pytest.raises(pliant.InputError, match="nowhere.csv"):
        pliant.identify(other, ["material.soft.youngs_modulus"], "nowhere.csv")
    with pytest.raises(pliant.InputError, match="judge is"):
        pliant.identify(other, ["material.soft.youngs_modulus"], table, judge="some")


def test_the_gradient_of_a_program_agrees_with_finite_differences():
    tip = pliant.Measure("marker", "tip", (0, 0, 1))

    def height(step, values):
        return (1e3 * values[0]) ** 2 if step == 4 else 0.0

    def judge(step, values):
        return height(step, values), [2e6 * values[0] if step == 4 else 0.0]

    def model(density):
        robot = bar(program={"steps": 4, "gravity": [0, 0, -9.81], "tolerance": 1e-9}).robot
        return pliant.Model(robot.changed({"material.soft.density": f"{density} kg/m^3"}))

    found = pliant.gradient(model(1100), [tip], judge, tets=True)
    assert found.values.shape == (4, 1)
    assert found.value == pytest.approx(height(4, found.values[3]))
    names = [p.name for p in found.parameters]
    by_density = found.by_parameters[names.index('material "soft": density')]
    measured = [pliant.gradient(model(d), [tip], judge).value for d in (1099, 1101)]
    assert by_density == pytest.approx((measured[1] - measured[0]) / 2, rel=1e-4)
    density = next(t for t in found.by_tets if t.name == "density")
    assert density.values.sum() == pytest.approx(by_density, rel=1e-9)
    assert len(found.instants) >= 4 and found.instants[-1].by_inputs.shape == (len(found.inputs),)


def test_numbers_of_the_drawing_have_derivatives():
    tip = pliant.Measure("marker", "tip", (0, 0, 1))

    def judge(step, values):
        return (1e3 * values[0], [1e3]) if step == 2 else (0.0, [0.0])

    def of(ratio, **options):
        cable = [{**BAR["cable"][0], "target": {"length_ratio": "= ratio"}}]
        model = bar(parameters={"ratio": ratio}, cable=cable, program={"steps": 2, "tolerance": 1e-10})
        return pliant.gradient(model, [tip], judge, **options)

    found = of(0.95, numbers=["ratio"])
    difference = (of(0.9501).value - of(0.9499).value) / 2e-4
    assert found.by_numbers == pytest.approx([difference], rel=1e-5)
    assert of(0.95).by_numbers.shape == (0,)
    with pytest.raises(pliant.InputError, match='has no number "ration"; did you mean "ratio"'):
        of(0.95, numbers="ration")


def test_a_measure_has_the_value_and_gradient_of_the_state():
    model = bar()
    state = model.solve({"flexor": {"shortening": "2 mm"}})
    at = model.linearise(state)
    tip = pliant.Measure("marker", "tip", (0, 0, 1))
    assert at.value(tip) == pytest.approx(state.markers()[0, 2], rel=1e-12)
    assert at.gradient_of(tip).controls == pytest.approx(model.jacobian(state)[0, 2], rel=1e-8)
    with pytest.raises(pliant.InputError, match='"place" cannot be measured; write one of marker, tension'):
        at.value(pliant.Measure("place", "tip"))


def test_invalid_objectives_are_refused():
    model = bar()
    tip = pliant.Measure("marker", "tip", (0, 0, 1))
    wrong = {
        "judge must give a number and its slopes, as (value, slopes)": lambda step, values: 3,
        "the slopes of judge has shape (2,); it must have shape (1,)": lambda step, values: (3, [1, 2]),
        "the value of judge is nan, which is not finite": lambda step, values: (float("nan"), [1]),
    }
    for text, judge in wrong.items():
        with pytest.raises(pliant.InputError) as caught:
            pliant.gradient(model, [tip], judge)
        assert str(caught.value) == text
    with pytest.raises(ZeroDivisionError):
        pliant.gradient(model, [tip], lambda step, values: (1 / 0, [1]))
