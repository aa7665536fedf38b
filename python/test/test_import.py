"""`import pliant` is quick: its files are imported when the first of their names is used."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import pliant


def names_for_the_type_checker():
    """Names that `if TYPE_CHECKING:` imports, by file."""
    tree = ast.parse(Path(pliant.__file__).read_text(encoding="utf-8"))
    block = next(part for part in tree.body if isinstance(part, ast.If))
    return {part.module: tuple(name.name for name in part.names) for part in block.body}


def test_nothing_heavy_is_imported_before_it_is_used():
    code = "import sys, pliant; print([name for name in ('numpy', 'pliant.model', 'subprocess') if name in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout == "[]\n"


def test_names_imported_on_use_are_those_that_the_type_checker_knows():
    assert pliant._NAMES_OF == names_for_the_type_checker()
    at_once = {"Cancelled", "Failure", "InputError", "MissingFile", "quantity"}
    assert {*pliant._FILE_OF, *at_once} == {*pliant.__all__}


def test_every_public_name_is_there():
    space = {}
    exec("from pliant import *", space)
    assert {*pliant.__all__} <= {*space}
    assert {*pliant.__all__, "envs", "plotting"} <= {*dir(pliant)}
    assert pliant.plotting.__name__ == "pliant.plotting"


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'pliant' has no attribute 'Modell'"):
        pliant.Modell  # noqa: B018


def test_the_module_can_be_inspected_without_torch():
    code = """
import sys
sys.modules["torch"] = None  # as if it were not installed
import inspect, pydoc, pliant
assert not hasattr(pliant, "torch")
assert "Model" in dict(inspect.getmembers(pliant))
assert "pliant.torch" not in sys.modules
print(pydoc.plain(pydoc.render_doc(pliant)).splitlines()[0])
for way in ("import pliant.torch", "from pliant import torch"):
    try:
        exec(way)
    except ImportError as error:
        print(error)
"""
    said = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    missing = "pliant.torch needs PyTorch (Debian: python3-torch)"
    assert said.splitlines() == ["Python Library Documentation: package pliant", missing, missing]
