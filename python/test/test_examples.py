"""The programs of examples/python do what they say."""

import importlib.util
import sys
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "python"


def load(name):
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def test_the_example_learn_to_reach_improves_and_repeats(tmp_path):
    example = load("learn_to_reach")
    curve, policy, model = example.learn(generations=5, population=12, goals_each=2, steps=8, seed=1)
    assert curve[-1][0] < 0.6 * curve[0][0], curve
    again, same, _ = example.learn(generations=2, population=12, goals_each=2, steps=8, seed=1, model=model)
    assert again == curve[:2]
