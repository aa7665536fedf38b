"""What is shown: pages for notebooks, pictures with matplotlib."""

import base64
import json
import re
import struct

import numpy as np
import pytest
from robots import bar

import pliant


@pytest.fixture(scope="module")
def model():
    return bar()


@pytest.fixture(scope="module")
def states(model):
    return [model.solve({"flexor": {"shortening": f"{k} mm"}}) for k in (0.1, 2, 4)]


def packets(page):
    """The head and the arrays of what a page shows."""
    shown = json.loads(re.search(r'<script type="application/json" id="robot">(.*?)</script>', page).group(1))
    return shown, [packet(shown["scene"])] + [packet(f) for f in shown["frames"]]


def packet(text):
    data = base64.b64decode(text)
    assert data[:4] == b"PLN1"
    (length,) = struct.unpack_from("<I", data, 4)
    head = json.loads(data[8 : 8 + length])
    arrays, at = {}, 8 + length
    for entry in head["arrays"]:
        kind = {"f32": np.float32, "u32": np.uint32}[entry["type"]]
        arrays[entry["name"]] = np.frombuffer(data, kind, entry["count"], at)
        at += 4 * entry["count"]
    assert at == len(data)
    return head["head"], arrays


def test_a_page_shows_the_robot_and_loads_nothing_from_outside(states, tmp_path):
    viewer = pliant.show(states, field="von_mises")
    shown, ((scene, still), *frames) = packets(viewer.page)
    assert shown["field"] == "von_mises" and len(frames) == 3 and "flexor" in shown["labels"][2]
    assert scene["robot"] == "bar" and scene["cable_points"] == [3]
    for state, (head, arrays) in zip(states, frames):
        assert head["markers"][0] == pytest.approx((1e3 * state.markers()[0]).tolist())
        assert arrays["positions"].size == still["rest"].size == arrays["von_mises"].size * 3
    assert not np.array_equal(frames[0][1]["positions"], frames[2][1]["positions"])
    body = re.sub(r"/\*.*?\*/", "", viewer.page, flags=re.S)
    assert not re.search(r"""(src|href)=["'](?!data:)""", body) and "import(" not in body
    viewer.write(tmp_path / "robot.html")
    assert (tmp_path / "robot.html").read_text() == viewer.page
    frame = viewer._repr_html_()
    assert frame.startswith("<iframe srcdoc=") and "allow-same-origin" not in frame and frame.count('"') == 6


def test_models_states_and_programs_are_shown(model, states):
    assert len(packets(pliant.show(model).page)[1]) == 2
    assert len(packets(pliant.show(states[1]).page)[1]) == 2
    assert len(packets(pliant.show(model.run()).page)[1]) == 6
    assert len(packets(pliant.show(iter(states)).page)[1]) == 4
    for wrong in (3, [1], "finger.toml", np.array(3)):
        with pytest.raises(TypeError, match="show takes a model, a state"):
            pliant.show(wrong)
    with pytest.raises(pliant.InputError, match="not all of one model"):
        pliant.show([states[0], bar().rest()])
    with pytest.raises(pliant.InputError, match="^there are no states to show; give at least one$"):
        pliant.show([])
    for height in (-5, 0, 10001):
        with pytest.raises(pliant.InputError, match=f"^height_px is {height}; it must be from 16 to 10000$"):
            pliant.show(model, height_px=height)
    with pytest.raises(pliant.InputError, match="field is material, displacement"):
        pliant.show(model, field="colour")


def test_pictures_show_the_robot(model, states):
    pytest.importorskip("matplotlib").use("Agg")
    plain = pliant.plotting.picture(states[2], size_px=(320, 240))
    coloured = pliant.plotting.picture(states[2], field="von_mises", size_px=(320, 240))
    assert plain.shape == coloured.shape == (240, 320, 3) and plain.dtype == np.uint8
    assert not np.array_equal(plain, coloured)
    assert (plain != 255).any(axis=2).mean() > 0.02
    with pytest.raises(pliant.InputError, match="field is displacement"):
        pliant.plotting.plot(states[2], field="colour")
    axes = pliant.plotting.plot(model, edges=True)
    assert axes.get_xlabel() == "x (mm)"
    upper, lower = pliant.plotting.plot_program(model.run())
    assert len(upper.lines) == len(lower.lines) == 1


def test_values_in_a_picture_equal_those_of_the_state(states):
    values = pliant.plotting.field_values(states[2], "von_mises")
    assert np.array_equal(values, 1e-3 * states[2].fields().von_mises_Pa)
    moved = pliant.plotting.field_values(states[2], "displacement")
    assert moved.max() == pytest.approx(1e3 * np.linalg.norm(states[2].displacements, axis=1).max(), rel=0.2)
    tets = pliant.plotting._tet_of_face(states[2], states[2].model.surface())
    corners = states[2].model.tets[tets][:, :4]
    assert all(set(f) <= set(c) for f, c in zip(states[2].model.surface().tolist(), corners.tolist()))
