"""From a robot to a job, its plan, its proof and a print on the virtual printer."""

import json
import os
import subprocess

import numpy as np
import pytest
from robots import BAR, BLOCK

import pliant

FINGER = "examples/tutorial/finger.toml"
TOWER = "examples/printers/tower.toml"


@pytest.fixture(scope="module")
def job(tmp_path_factory):
    file = tmp_path_factory.mktemp("job") / "finger.zip"
    plan = pliant.slice(FINGER, file, printer=TOWER, layer="0.1 mm")
    return file, plan


def test_a_plan_equals_that_of_the_command_line(job):
    file, plan = job
    assert plan == pliant.plan(file) and plan.layers > 10 and plan.vats[0].resin_ml > 0
    run = [os.environ["PLIANT_PROGRAM"], "plan", str(file), "--json"]
    told = json.loads(subprocess.run(run, check=True, capture_output=True, text=True).stdout)
    assert (told["layers"], told["swaps"]) == (plan.layers, plan.swaps)
    assert told["seconds"]["total"] == round(plan.seconds, 3)
    vats = [(v["slot"], v["refill"], [r["layer"] for r in v["refills"]]) for v in told["vats"]]
    assert vats == [(v.slot, v.refill, v.refills) for v in plan.vats]
    assert isinstance(pliant.check(file), list)
    with pytest.raises(pliant.Cancelled):
        pliant.check(file, progress=lambda *_: False)


def test_the_cured_block_has_the_volume_of_the_part(job):
    file, plan = job
    seen = []
    print_ = pliant.print_virtually(file, block=True, progress=lambda stage, share: seen.append(share))
    assert print_.passed, print_.reasons
    block = print_.block
    assert block.resin.shape == block.share.shape == (plan.layers, *block.resin.shape[1:])
    assert not block.resin.flags.writeable
    volumes = block.volumes_mm3()
    assert sum(volumes.values()) == pytest.approx(sum(print_.cured_mm3.values()), rel=1e-3)
    assert np.array_equal(block.resin > 0, block.share > 0)
    size = np.array(block.resin.shape[::-1][:2]) * block.pixel_mm
    assert size == pytest.approx([80, 12], abs=2.1 * block.pixel_mm)  # the finger of 80 x 12 x 12 mm
    assert block.tops_mm[-1] == pytest.approx(12, abs=0.2) and len(block.bottoms_mm) == plan.layers
    assert pliant.print_virtually(file).block is None


def test_a_print_can_be_cancelled_and_a_bad_job_is_refused(job, tmp_path):
    file, _ = job
    with pytest.raises(pliant.Cancelled):
        pliant.print_virtually(file, progress=lambda stage, share: False)
    with pytest.raises(pliant.Cancelled):
        pliant.slice(FINGER, tmp_path / "no.zip", printer=TOWER, progress=lambda stage, share: False)
    assert not (tmp_path / "no.zip").exists()
    broken = tmp_path / "broken.zip"
    broken.write_bytes(file.read_bytes()[:5000])
    for work in (pliant.check, pliant.plan, pliant.print_virtually):
        with pytest.raises(pliant.Failure, match="broken.zip"):
            work(broken)


def test_a_built_in_printer_is_named(job, tmp_path):
    file, plan = job
    named = tmp_path / "named.zip"
    assert pliant.slice(FINGER, named, printer="tower", layer="0.1 mm") == plan
    assert named.read_bytes() == file.read_bytes()
    with pytest.raises(pliant.InputError, match='towr: there is no such file or built-in printer; did you mean "tower"'):
        pliant.slice(FINGER, tmp_path / "no.zip", printer="towr")


def test_a_robot_made_in_python_can_be_sliced(job, tmp_path):
    _, plan = job
    robot = pliant.Robot.load(FINGER)
    assert pliant.slice(robot, tmp_path / "a.zip", printer=TOWER, layer="0.1 mm", support=None).layers == plan.layers
    changed = pliant.Robot({**BAR, "body": [{**BAR["body"][0], "geometry": {"box": [[0, 0, 0], [9, 9, "= 2 * h"]]}}]},
                           parameters={"h": 3}).changed({"parameters.h": 4})
    options = {"printer": TOWER, "layer": "0.1 mm", "resins": {"soft": "soft"}, "any_vat": True}
    assert pliant.slice(changed, tmp_path / "b.zip", **options).layers == 80
    assert pliant.slice(FINGER, tmp_path / "c.zip", printer=TOWER, layer=None, copies=1).layers > 10
    with pytest.raises(pliant.Failure) as caught:
        pliant.slice(pliant.Robot(BLOCK), tmp_path / "d.zip", **options)
    assert "/tmp" not in str(caught.value)
