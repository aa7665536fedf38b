"""mypy knows the module: what is right passes, what is wrong does not."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent


def checked(file, tmp_path, *options):
    pytest.importorskip("mypy", reason="mypy is not installed")
    run = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", f"--cache-dir={tmp_path}", *options, str(file)]
    environment = {**os.environ, "MYPYPATH": ""}
    return subprocess.run(run, capture_output=True, text=True, env=environment).stdout


def test_correct_code_passes_the_type_checker(tmp_path):
    assert checked(HERE / "sample.py", tmp_path) == ""


def test_the_type_checker_finds_mistakes(tmp_path):
    wrong = tmp_path / "wrong.py"
    wrong.write_text(
        "import pliant\n"
        "model = pliant.Model('finger.toml')\n"
        "state: pliant.State = model.observe(model.rest())\n"
        "model.step(model.rest(), tme=1.0)\n"
        "model.rest().positons\n"
        "pliant.Modle\n"
        "pliant.envs.Raech()\n"
    )
    said = checked(wrong, tmp_path)
    assert [line.split(":")[1] for line in said.splitlines() if ": error:" in line] == list("234567"), said


def test_the_module_itself_passes_the_type_checker(tmp_path):
    import pliant

    said = checked(Path(pliant.__file__).parent, tmp_path, "--ignore-missing-imports", "--exclude=torch.py")
    assert said == "", said
