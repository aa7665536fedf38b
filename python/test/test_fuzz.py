"""A short run of fuzz.py in a process of its own: a crash of the interpreter is seen. fuzz_asan runs it for long.

The number of calls is fixed, so that every machine makes the same ones.
"""

import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.parametrize("seed", [1, 2])
def test_wrong_calls_never_crash(seed):
    fuzz = Path(__file__).with_name("fuzz.py")
    command = [sys.executable, str(fuzz), "100", str(seed), "500"]
    run = subprocess.run(command, capture_output=True, text=True, timeout=200)
    assert run.returncode == 0, (run.stdout + run.stderr)[-3000:]
    assert int(run.stdout.split()[0]) > 100
