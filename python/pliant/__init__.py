"""Simulates multi-material soft robots, and slices, plans and prints them.

    import pliant

    model = pliant.Model(pliant.Robot.load("finger.toml"))
    state = model.rest()
    model.step(state, {"flexor": {"shortening": "4 mm"}})
    print(state.observe().markers["tip"], state.observe().cables["flexor"].tension_N)

Robot files keep their own units; everything here is in SI units: metres, newtons, pascals, seconds. Errors are
:class:`Failure` or one of its subclasses, described in one sentence. A model may be used by any number of threads.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _pliant
from .errors import Cancelled, Failure, InputError, MissingFile

if TYPE_CHECKING:
    from ._pliant import StepResult
    from .batch import Batch
    from .controls import Drive, Inputs
    from .identification import Comparison, Estimate, FitError, Identification, identify
    from .linearisation import Change, Gradient, GuidePoint, Linearisation, Measure, Parameter
    from .model import Model, State
    from .notebook import Viewer, show
    from .objectives import ProgramGradient, gradient
    from .printing import CuredBlock, PrintPlan, Vat, VirtualPrint, check, plan, print_virtually, slice
    from .program import ProgramResult, ProgramStep
    from .reduced import ReducedCheck, ReducedError, ReducedModel, ReducedState, ReducedStep, reduce
    from .results import Cable, Chamber, Fields, Joint, Object, Observation, Spring
    from .robot import Mesh, Robot
    from .steering import GoalResult, InverseResult, SteeredInput, Waypoint, Workspace, inverse, workspace
    from .studies import KeySensitivity, SobolIndex, StudyResult, study

__version__ = _pliant.version()

__all__ = [
    "Batch", "Cable", "Cancelled", "Chamber", "Change", "Comparison", "CuredBlock", "Drive", "Estimate", "Failure",
    "Fields", "FitError", "GoalResult", "Gradient", "GuidePoint", "Identification", "InputError", "Inputs",
    "InverseResult", "Joint", "KeySensitivity", "Linearisation", "Measure", "Mesh", "MissingFile", "Model", "Object",
    "Observation", "Parameter", "PrintPlan", "ProgramGradient", "ProgramResult", "ProgramStep", "ReducedCheck",
    "ReducedError", "ReducedModel", "ReducedState", "ReducedStep", "Robot", "SobolIndex", "Spring", "State",
    "SteeredInput", "StepResult", "StudyResult", "Vat", "Viewer", "VirtualPrint", "Waypoint", "Workspace", "check",
    "gradient", "identify", "inverse", "plan", "print_virtually", "quantity", "reduce", "show", "slice", "study",
    "workspace",
]  # fmt: skip


def quantity(text: str, unit: str) -> float:
    """Converts a text with a unit, as in robot files, to SI units: ``quantity("4 mm", "m")`` is 0.004.

    Args:
        text: a number and its unit.
        unit: the required unit: m, s, N, Pa, m^3, kg/m^3 or N/m.

    Raises:
        InputError: the text is no quantity of this kind, or is too large.
    """
    if not isinstance(text, str) or not isinstance(unit, str):
        raise TypeError('quantity takes two texts, as quantity("4 mm", "m")')
    from ._check import text as checked

    return _pliant.quantity(checked(text, "text"), checked(unit, "unit"))


#: Names of each file, which is imported when the first of them is used: `import pliant` stays quick.
_NAMES_OF = {
    "_pliant": ("StepResult",),
    "batch": ("Batch",),
    "controls": ("Drive", "Inputs"),
    "identification": ("Comparison", "Estimate", "FitError", "Identification", "identify"),
    "linearisation": ("Change", "Gradient", "GuidePoint", "Linearisation", "Measure", "Parameter"),
    "model": ("Model", "State"),
    "notebook": ("Viewer", "show"),
    "objectives": ("ProgramGradient", "gradient"),
    "printing": ("CuredBlock", "PrintPlan", "Vat", "VirtualPrint", "check", "plan", "print_virtually", "slice"),
    "program": ("ProgramResult", "ProgramStep"),
    "reduced": ("ReducedCheck", "ReducedError", "ReducedModel", "ReducedState", "ReducedStep", "reduce"),
    "results": ("Cable", "Chamber", "Fields", "Joint", "Object", "Observation", "Spring"),
    "robot": ("Mesh", "Robot"),
    "steering": ("GoalResult", "InverseResult", "SteeredInput", "Waypoint", "Workspace", "inverse", "workspace"),
    "studies": ("KeySensitivity", "SobolIndex", "StudyResult", "study"),
}
_FILE_OF = {name: file for file, names in _NAMES_OF.items() for name in names}
_FILES = {*_NAMES_OF, "envs", "plotting", "torch"}


if TYPE_CHECKING:
    from . import envs as envs
    from . import plotting as plotting
    from . import torch as torch
else:  # a type checker would take every name for known

    def __getattr__(name: str) -> Any:
        from importlib import import_module

        if name in _FILE_OF:
            found = getattr(import_module("." + _FILE_OF[name], __name__), name)
            globals()[name] = found
            return found
        if name == "torch":
            try:
                return import_module(".torch", __name__)
            except ImportError as error:  # so that hasattr() and help() pass over it
                raise AttributeError(str(error)) from error
        if name in _FILES:
            return import_module("." + name, __name__)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, *_FILES})
