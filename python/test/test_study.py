"""Studies from Python: the same rows as on the command line, as arrays."""

import json
import os
import subprocess

import numpy as np
import pytest
from robots import BAR

import pliant
from pliant import _toml

#: The bar, stretched by a support: no cable, one step.
STRETCHED = {
    **{key: value for key, value in BAR.items() if key != "cable"},
    "mesh": {"order": 1, "size": "10 mm"},
    "fixed": [*BAR["fixed"], {"name": "end", "box": [[60, 0, 0], [60, 10, 10]], "move": [3, 0, 0]}],
    "program": {"steps": 1},
}


def plan(**changes):
    return {
        "command": ["simulate", "bar.toml"],
        "plan": "grid",
        "key": {"modulus": {"set": "material.soft.youngs_modulus", "range": ["1 MPa", "3 MPa"], "levels": 3}},
        "result": {"force": "supports.end.force_N[0]", "tip": "markers.tip[0]"},
        **changes,
    }


@pytest.fixture
def place(tmp_path):
    (tmp_path / "bar.toml").write_text(_toml.document(STRETCHED))
    return tmp_path


def test_study_results_are_arrays_and_agree_with_the_closed_form(place):
    found = pliant.study(plan(), place / "out", jobs=2)
    assert len(found) == 3 and found.done.all() and (found.reasons == "").all() and (found.warnings == "").all()
    assert found.units == {"modulus": "MPa"}
    assert found.keys["modulus"].tolist() == [1, 2, 3]
    # At a given stretch and Poisson ratio every stress is proportional to Young's modulus; 1e-6: what the solver leaves.
    force = found.results["force"]
    assert abs(force[0]) > 1
    assert force / force[0] == pytest.approx([1, 2, 3], rel=1e-6)
    assert found.results["tip"] == pytest.approx([63, 63, 63], abs=1e-4)
    assert found.sensitivity == {}
    again = pliant.StudyResult.load(place / "out")
    assert np.array_equal(again.results["force"], force)


def test_a_study_equals_that_of_the_command_line(place):
    found = pliant.study(plan(), place / "here")
    run = [os.environ["PLIANT_PROGRAM"], "study", str(place / "here.toml"), "-o", str(place / "there"), "--json"]
    told = json.loads(subprocess.run(run, check=True, capture_output=True, text=True).stdout)
    assert told["results"] == found.summary["results"]
    assert (place / "here" / "results.csv").read_bytes() == (place / "there" / "results.csv").read_bytes()
    with pytest.raises(pliant.InputError, match="is a folder; a study file is needed here$"):
        pliant.study(place / "here")
    with pytest.raises(pliant.InputError, match="resume=True goes on"):
        pliant.study(place / "here.toml", place / "here")
    assert len(pliant.study(place / "here.toml", place / "here", resume=True)) == 3


def test_sensitivity_is_one_for_the_modulus_and_zero_for_the_marker(place):
    # The force is proportional to the modulus; where the marker sits changes nothing.
    keys = {
        "modulus": {"set": "material.soft.youngs_modulus", "range": ["1 MPa", "3 MPa"]},
        "mark": {"set": "marker.tip.point", "values": ["[60, 5, 5]", "[60, 2, 2]"]},
    }
    found = pliant.study(plan(plan="sensitivity", samples=32, key=keys), place / "out")
    assert len(found) == 32 * 4 and found.done.all()
    force = found.sensitivity["force"]
    assert force["modulus"].first.value == pytest.approx(1, abs=0.1)
    assert force["modulus"].total.value == pytest.approx(1, abs=0.1)
    assert force["mark"].total.value == pytest.approx(0, abs=1e-9)
    assert found.keys["mark"].dtype.kind == "U"


def test_rows_that_fail_are_kept(place):
    found = pliant.study(
        plan(key={"poisson": {"set": "material.soft.poisson_ratio", "values": [0.3, 0.7]}}), place / "out"
    )
    assert found.done.tolist() == [True, False]
    assert np.isnan(found.results["force"][1]) and "poisson_ratio" in found.reasons[1]


def test_mistakes_are_reported(place):
    with pytest.raises(pliant.InputError, match="did you mean"):
        pliant.study(plan(plan="gird"), place / "a")
    with pytest.raises(pliant.InputError, match="there is clamp and end"):
        pliant.study(plan(result={"force": "supports.nd.force_N[0]"}), place / "b")
    with pytest.raises(pliant.InputError, match="folder"):
        pliant.study(plan())
    with pytest.raises(pliant.InputError, match="no folder of a study"):
        pliant.StudyResult.load(place)


def test_wrong_options_are_refused_with_the_reason(place):
    for jobs, text in {0: "jobs is 0", 1.7: "jobs must be a whole number", "x": "jobs must be a whole number"}.items():
        with pytest.raises(pliant.InputError, match=text):
            pliant.study(plan(), place / "out", jobs=jobs)
    with pytest.raises(pliant.InputError, match="on is local or slurm"):
        pliant.study(plan(), place / "out", on="cloud")
    assert not (place / "out.toml").exists()


def test_the_reason_of_the_program_is_shown(place, monkeypatch):
    with pytest.raises(pliant.InputError, match="is missing.*\n.*did you mean"):
        pliant.study({"command": ["simulate", "bar.toml"], "plan": "gird", "key": plan()["key"]}, place / "a")
    stand_in = place / "pliant"
    said = "--jobs: not so"
    stand_in.write_text(f"#!/bin/sh\ncat >&2 <<END\n{said}\nEND\nexit 2\n")
    stand_in.chmod(0o755)
    monkeypatch.setenv("PLIANT_PROGRAM", str(stand_in))
    with pytest.raises(pliant.InputError, match="^--jobs: not so$"):
        pliant.study(plan(), place / "b")


def test_a_file_that_is_not_the_same_study_is_never_overwritten(place):
    mine = place / "finger.toml"
    mine.write_text("name = 'mine'\n")
    with pytest.raises(pliant.InputError, match="finger.toml: is there already, and is another study"):
        pliant.study(plan(), place / "finger")
    assert mine.read_text() == "name = 'mine'\n"
    with pytest.raises(pliant.InputError, match="did you mean"):
        pliant.study(plan(plan="gird"), place / "out")
    assert pliant.study(plan(), place / "out").done.all()
    kept = (place / "out.toml").read_text()
    with pytest.raises(pliant.InputError, match="another study"):
        pliant.study(plan(result={"tip": "markers.tip[0]"}), place / "out")
    assert (place / "out.toml").read_text() == kept
    assert len(pliant.study(plan(), place / "out", resume=True)) == 3
    assert not list(place.glob("*.partial"))
