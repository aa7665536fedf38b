"""What people get wrong ends in one sentence, with its place."""

import errno
import os
import pickle

import numpy as np
import pytest
from robots import BAR, BLOCK, bar, block, cube

import pliant


@pytest.fixture(scope="module")
def model():
    return bar()


def without(key):
    return {k: v for k, v in BAR.items() if k != key}


def body(**changes):
    return {**BAR, "body": [{**BAR["body"][0], **changes}]}


LOOP = []
LOOP.append(LOOP)

MISTAKES = {
    "a unit is forgotten": (
        lambda m: pliant.Robot({**BAR, "material": {"soft": {"youngs_modulus": 12}}}),
        'material.soft.youngs_modulus: 12 has no unit; write a pressure such as "12 MPa"',
    ),
    "a key is misspelt": (
        lambda m: pliant.Robot(body(geometri={"box": [[0, 0, 0], [1, 1, 1]]})),
        'body[0].geometri: unknown key; did you mean "geometry"?',
    ),
    "a material is misspelt": (
        lambda m: pliant.Robot(body(material="sofd")),
        'body[0].material: no material "sofd"; did you mean "soft"?',
    ),
    "a file is given where keys are due": (
        lambda m: pliant.Robot("finger.toml"),
        "a Robot is made of keys, as Robot(name=...) or Robot({...}); a file is read by Robot.load(file), text by "
        "Robot.parse(text)",
    ),
    "a file is not there": (lambda m: pliant.Robot.load("nowhere.toml"), "nowhere.toml: no such file"),
    "a number does not say what it is": (
        lambda m: m.step(m.rest(), {"flexor": 0.9}),
        'cable "flexor": 0.9 does not say what it is; write {"length_ratio": 0.9}, {"shortening": "4 mm"} or '
        '{"tension": "2 N"}',
    ),
    "a cable is misspelt": (
        lambda m: m.step(m.rest(), {"flexer": {"length_ratio": 0.9}}),
        "there is no cable or chamber 'flexer'; there are flexor",
    ),
    "a cable is inflated": (
        lambda m: m.step(m.rest(), {"flexor": {"pressure": "2 kPa"}}),
        "cable \"flexor\": 'pressure' is not known; write one of length, length_ratio, shortening, tension",
    ),
    "a unit does not fit": (
        lambda m: m.step(m.rest(), {"flexor": {"shortening": "4 N"}}),
        'cable "flexor": shortening: unknown unit "N"; here the units are mm, m, cm, um, µm, in',
    ),
    "too many controls": (
        lambda m: m.step(m.rest(), [0.05, 0.05]),
        "controls has shape (2,); it must have shape (1,)",
    ),
    "a control is no number": (
        lambda m: m.step(m.rest(), [np.nan]),
        'cable "flexor": driven by a number that is not finite',
    ),
    "a model is taken for a state": (lambda m: m.step(m, [0.05]), "state must be a pliant.State, not Model"),
    "a robot is taken for a model": (
        lambda m: pliant.Model("finger.toml"),
        "robot must be a pliant.Robot, not str",
    ),
    "a state is of another model": (
        lambda m: m.observe(block().rest()),
        "the state is one of another model",
    ),
    "bytes are of another model": (
        lambda m: m.state_from(b"nothing"),
        "not a state that Pliant has written, or damaged",
    ),
    "a marker is misspelt": (
        lambda m: m.grad(m.rest(), markers={"top": [0, 0, 1]}),
        "there is no marker 'top'; there are tip",
    ),
    "a mesh has the wrong shape": (
        lambda m: pliant.Mesh(np.zeros((3, 2)), [[0, 1, 2, 3]]),
        "points has shape (3, 2); it must have shape (any, 3)",
    ),
    "a mesh names a point that is not there": (
        lambda m: pliant.Model(pliant.Robot(BLOCK), pliant.Mesh(cube().points, [[0, 1, 2, 9]])),
        "the mesh: ",
    ),
    "a mesh is forgotten": (
        lambda m: pliant.Model(pliant.Robot(BLOCK)),
        "mesh: file: pass the mesh in memory, as mesh=pliant.Mesh(...)",
    ),
    "a mesh in memory is sliced": (
        lambda m: pliant.slice(pliant.Robot(BLOCK), "no.zip", printer="examples/printers/tower.toml"),
        "mesh: file: a mesh in memory cannot be sliced; name a file",
    ),
    "a mesh has no regions": (
        lambda m: pliant.Mesh(cube().points, cube().tets, None, ()),
        'region_names is empty; give at least one name, as ("all",)',
    ),
    "a region has no name": (
        lambda m: pliant.Mesh(cube().points, cube().tets, None, ("a", "")),
        "one of region_names is empty; bodies refer to regions by their names",
    ),
    "two regions have one name": (
        lambda m: pliant.Mesh(cube().points, cube().tets, None, ("a", "b", "a")),
        "region_names has 'a' twice; each region needs a name of its own",
    ),
    "a region is not there": (
        lambda m: pliant.Mesh(cube().points, cube().tets, [0, 0, 0, 0, 0, 2], ("a", "b")),
        "regions has 2; with these region_names it must be from 0 to 1",
    ),
    "a checkpoint is not there": (
        lambda m: m.run(checkpoint="nowhere", resume=True),
        "nowhere: no checkpoint is there; run(checkpoint=FOLDER) makes one",
    ),
    "a table has no name": (
        lambda m: pliant.identify(m.robot, ["material.soft.youngs_modulus"], ""),
        "measured is an empty text; write a path",
    ),
    "a table is a folder": (
        lambda m: pliant.identify(m.robot, ["material.soft.youngs_modulus"], "/tmp"),
        "/tmp: is a folder, a file is needed",
    ),
    "a file has no name": (lambda m: pliant.Robot.load(""), "file is an empty text; write a path"),
    "a layer is empty": (
        lambda m: pliant.slice("a.toml", "a.zip", printer="b.toml", layer=""),
        "layer is an empty text; leave it out, or write what it is",
    ),
    "a quantity is too large": (
        lambda m: pliant.quantity("1e308 GPa", "Pa"),
        '"1e308 GPa" is too large',
    ),
    "a target is too large": (
        lambda m: m.step(m.rest(), {"flexor": {"tension": "1e308 kN"}}),
        'cable "flexor": tension: "1e308 kN" is too large',
    ),
    "controls are masked": (
        lambda m: m.step(m.rest(), np.ma.array([0.058], mask=[True])),
        "controls has masked entries; give a number for each, as .filled(0) does",
    ),
    "a batch is too large": (
        lambda m: pliant.Batch(m, 2 * 10**8),
        "count is 200000000; a batch has 0 to 100,000 robots",
    ),
    "a folder of a study is not there": (
        lambda m: pliant.StudyResult.load("nostudy"),
        "nostudy: is no folder of a study that has ended: it has no summary.json",
    ),
    "a time is too large": (lambda m: m.program(10**400), "time is 1000"),
    "measures are forgotten": (
        lambda m: pliant.gradient(m, None, lambda step, values: (0.0, [])),
        "measures must be a list of pliant.Measure, not None",
    ),
    "one measure is given for several": (
        lambda m: pliant.gradient(m, pliant.Measure("tension", "flexor"), lambda step, values: (0.0, [])),
        "measures must be a list of pliant.Measure, not Measure",
    ),
    "pictures have one size": (
        lambda m: m.run().write("nowhere", picture_size_px=300),
        "picture_size_px must be (width, height)",
    ),
    "a program is plotted into numbers": (
        lambda m: pliant.plotting.plot_program(m.run(), axes=[1, 2]),
        "axes must be two axes, one for markers and one for tensions and pressures",
    ),
    "a tolerance is impossible": (
        lambda m: pliant.Model(m.robot, tolerance=2),
        "a tolerance of 2 is not possible: it is between 1e-10 and 0.1",
    ),
    "a value has no place in a robot file": (
        lambda m: pliant.Robot({**BAR, "name": object()}),
        "name: an object has no place in a robot file; write text, a number, True or False, a list or a dict",
    ),
    "a job is not there": (lambda m: pliant.plan("nowhere.zip"), None),
    "a name has half a character": (
        lambda m: pliant.Robot({**BAR, "name": "b\udcff"}),
        "the text 'b\\udcff' has '\\udcff', which is no character: it has no place in a text",
    ),
    "a text has half a character": (lambda m: pliant.Robot.parse("name = 'b\udcff'"), "text has '\\udcff'"),
    "a change has half a character": (lambda m: m.robot.changed(["name=b\udcff"]), "changes has '\\udcff'"),
    "a quantity has half a character": (lambda m: pliant.quantity("4\ud800 mm", "m"), "text has '\\ud800'"),
    "a control has half a character": (
        lambda m: m.inputs({"flexor": {"shortening": "4\ud800 mm"}}),
        "cable \"flexor\": shortening: the text has '\\ud800'",
    ),
    "a path has half a character": (lambda m: pliant.plan("\ud800.zip"), "job has '\\ud800'"),
    "a path is not UTF-8": (lambda m: pliant.plan(os.fsdecode(b"no\xff.zip")), "no\ufffd.zip: no such file"),
    "a file to slice is not UTF-8": (
        lambda m: pliant.slice(os.fsdecode(b"no\xff.toml"), "no.zip", printer="examples/printers/tower.toml"),
        "no\ufffd.toml: ",
    ),
    "a resin is None": (
        lambda m: pliant.slice("no.toml", "no.zip", printer="no.toml", resins={"soft": None}),
        "the resin of soft must be a text, not None",
    ),
    "a measured thing has half a character": (
        lambda m: m.linearise(m.rest()).value(pliant.Measure("tension", "\udcff")),
        "name has '\\udcff'",
    ),
    "a path is no text": (lambda m: pliant.Robot.load("b\udcff"), "b\ufffd: no such file"),
    "a list contains itself": (lambda m: pliant.Robot({**BAR, "marker": LOOP}), "a list or dict contains itself"),
    "resins are a list": (
        lambda m: pliant.slice("a.toml", "a.zip", printer="b.toml", resins=["soft"]),
        'resins must be a dict, as {"soft": "elastic 50A"}',
    ),
    "a state is saved as a folder": (lambda m: m.rest().save("/tmp"), "/tmp: is a folder; write the name of a file"),
    "a state is saved in a folder that is not there": (
        lambda m: m.rest().save("no/such/place"),
        "no/such/place: there is no folder no/such",
    ),
    "a direction is forgotten": (
        lambda m: m.linearise(m.rest()).value(pliant.Measure("marker", "tip")),
        'a measure of marker "tip" needs a direction, such as (0, 0, 1)',
    ),
    "a direction of a reaction is forgotten": (
        lambda m: m.linearise(m.rest()).gradient_of(pliant.Measure("reaction", "clamp")),
        'a measure of support "clamp" needs a direction, such as (0, 0, 1)',
    ),
    "nothing is measured": (
        lambda m: pliant.gradient(m, [], lambda step, values: (0.0, [])),
        'measures is empty; name what is measured, as Measure("tension", "flexor")',
    ),
    "positions are not finite": (
        lambda m: m.grad(m.rest(), positions=np.full((m.node_count, 3), np.nan)),
        "positions has a number that is not finite",
    ),
    "tensions are not finite": (
        lambda m: m.grad(m.rest(), tensions=[np.nan]),
        "tensions has a number that is not finite",
    ),
    "weights of a marker are not finite": (
        lambda m: m.grad(m.rest(), markers={"tip": [0, np.inf, 0]}),
        "markers['tip'] has a number that is not finite",
    ),
    "a right-hand side is not finite": (
        lambda m: m.linearise(m.rest()).solve(np.full(m.linearise(m.rest()).size, np.nan)),
        "b has a number that is not finite",
    ),
    "slopes are not finite": (
        lambda m: pliant.gradient(m, [pliant.Measure("tension", "flexor")], lambda step, values: (0.0, [np.nan])),
        "the slopes of judge has a number that is not finite",
    ),
    "a tetrahedron is listed twice": (
        lambda m: pliant.Model(pliant.Robot(BLOCK), pliant.Mesh(cube().points, [*cube().tets, cube().tets[0]])),
        "mesh: tetrahedra 0 and 6 are the same",
    ),
    "a change names nothing": (
        lambda m: m.robot.changed({"parameters.width": 3}),
        "changes: parameters.width: the file has no",
    ),
    "a layer has no unit": (
        lambda m: pliant.slice(
            "examples/tutorial/finger.toml", "no.zip", printer="examples/printers/tower.toml", layer="50"
        ),
        "layer",
    ),
    "models are forgotten": (
        lambda m: pliant.Batch(None),
        "models must be a pliant.Model or several, not NoneType",
    ),
    "a view is one number": (
        lambda m: pliant.plotting.plot(m, view=30),
        "view has shape (); it must have shape (2,)",
    ),
    "a picture has one size": (
        lambda m: pliant.plotting.picture(m, size_px=300),
        "size_px must be two whole numbers, width and height",
    ),
    "a model is plotted as a program": (
        lambda m: pliant.plotting.plot_program(m),
        "result must be a pliant.ProgramResult, not Model",
    ),
    "progress cannot be called": (
        lambda m: m.step(m.rest(), [0.05], progress=True),
        "progress must be callable, as progress(stage, share), not bool",
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda mistake: mistake.replace(" ", "_"))
def test_a_mistake_gives_an_error_of_one_sentence(model, mistake):
    act, text = MISTAKES[mistake]
    with pytest.raises((pliant.InputError, TypeError)) as caught:
        act(model)
    said = str(caught.value)
    assert "\n" not in said and len(said) < 300 and "incompatible" not in said, said
    if text is not None:
        assert said.startswith(text), said
    else:
        assert len(said) > 20


def test_errors_have_file_line_and_key(tmp_path):
    file = tmp_path / "robot.toml"
    file.write_text(pliant.Robot(BAR).text.replace('"1 MPa"', "12"))
    with pytest.raises(pliant.InputError) as caught:
        pliant.Robot.load(file)
    error = caught.value
    assert (error.file, error.line, error.key, error.kind) == (str(file), 3, "material.soft.youngs_modulus", "input")
    assert isinstance(error, ValueError) and isinstance(error, pliant.Failure)
    with pytest.raises(pliant.InputError) as caught:
        pliant.Robot({**BAR, "material": {"soft": {"youngs_modulus": 12}}})
    assert (caught.value.file, caught.value.line) == ("", 0)
    assert caught.value.key == "material.soft.youngs_modulus"
    with pytest.raises(pliant.InputError, match="^robot text:1: name: ") as caught:
        pliant.Robot.parse("name = 3")
    assert (caught.value.file, caught.value.line, caught.value.key) == ("", 1, "name") and "/" not in str(caught.value)


def test_a_missing_file_is_what_python_raises_for_one(tmp_path):
    nowhere = str(tmp_path / "nowhere")
    for file, act in {
        nowhere + ".toml": pliant.Robot.load,
        nowhere + ".zip": pliant.plan,
        nowhere + ".csv": lambda file: pliant.identify(bar().robot, ["material.soft.youngs_modulus"], file),
    }.items():
        with pytest.raises(FileNotFoundError) as caught:
            act(file)
        error = caught.value
        assert (error.errno, error.filename, error.file) == (errno.ENOENT, file, file)
        assert str(error) == f"{file}: no such file"
        assert isinstance(error, pliant.InputError) and error.kind == "input"
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is pliant.MissingFile and (str(again), again.filename) == (str(error), file)


def test_a_file_that_a_robot_names_is_a_mistake_in_the_robot():
    with pytest.raises(pliant.InputError, match="there is no file .*nowhere.stl") as caught:
        pliant.Robot(body(geometry="nowhere.stl"))
    assert caught.value.key == "body[0].geometry" and not isinstance(caught.value, OSError)


def test_errors_of_a_changed_robot_name_the_file_that_it_was_read_from(tmp_path):
    file = tmp_path / "robot.toml"
    file.write_text(pliant.Robot(BAR).text)
    robot = pliant.Robot.load(file).changed({"mesh.order": 1})
    for again in (robot, pickle.loads(pickle.dumps(robot))):
        with pytest.raises(pliant.InputError) as caught:
            again.changed({"material.soft.poisson_ratio": 3})
        assert str(caught.value).startswith(f"{file}:3: ") and caught.value.file == str(file)


def test_a_folder_may_be_an_empty_text_for_the_current_one():
    assert pliant.Robot(BAR, folder="").folder == pliant.Robot(BAR).folder


def test_a_step_that_does_not_converge_is_reported():
    model = pliant.Model(bar().robot, iteration_limit=1)
    state = model.rest()
    result = model.step(state, {"flexor": {"shortening": "20 mm"}})
    assert not result.arrived and "iteration" in result.reason
    with pytest.raises(pliant.Failure) as caught:
        model.solve({"flexor": {"shortening": "20 mm"}})
    assert caught.value.kind == "failed" and not isinstance(caught.value, ValueError)


def errors_of_a_robot(robot):
    """Everything that fails because of it."""
    yield lambda: pliant.Model(robot.changed({"marker.tip.point": [99, 5, 5]}))
    ready = pliant.Model(robot)
    yield lambda: pliant.inverse(ready)
    yield lambda: pliant.reduce(ready)
    yield lambda: pliant.workspace(ready)
    yield lambda: pliant.identify(robot, ["material.soft.youngs_modulus"], "time,tip_x_mm\n")
    yield lambda: pliant.Model(robot, progress=lambda stage, share: False)


def test_errors_of_a_robot_made_in_python_name_no_file():
    for work in errors_of_a_robot(pliant.Robot(BAR)):
        with pytest.raises(pliant.Failure) as caught:
            work()
        assert "robot text" not in str(caught.value) and caught.value.file != "robot text", caught.value
        assert caught.value.line == 0
    with pytest.raises(pliant.InputError, match="^robot text:"):
        pliant.Model(pliant.Robot.parse(pliant.Robot(BAR).text, changes={"marker.tip.point": [99, 5, 5]}))
