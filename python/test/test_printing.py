"""From a robot to a job, its plan, its proof and a print on the virtual printer."""

import json
import os
import subprocess

import numpy as np
import pytest

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
    assert isinstance(pliant.check(file), list)


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
