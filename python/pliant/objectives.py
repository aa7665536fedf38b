"""Gradients of a whole program with respect to everything that it depends on."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Union

import numpy as np

from . import _check, _pliant
from ._check import Array, Progress
from ._values import Value, value_tuple
from .errors import InputError
from .linearisation import GuidePoint, Measure, Parameter
from .model import Model

#: Called with (step, values): the step, from 1, and (measures,) values; returns the cost and its (measures,) slopes.
Judge = Callable[[int, Array], tuple[float, Union[Array, Sequence[float]]]]


@value_tuple
class TetGradient(NamedTuple):
    """Derivative with respect to a property of each tetrahedron, as if each had its own material."""

    #: youngs_modulus, c10, density...
    name: str
    #: SI; "" if dimensionless
    unit: str
    #: (tets,); 0 if a tetrahedron has no such property
    values: Array


@value_tuple
class Instant(NamedTuple):
    """An equilibrium that was solved for: the end of a step, or a state in between if a step was halved."""

    #: step of the program, from 1
    step: int
    #: program time
    time: float
    #: (inputs,); empty: the objective does not depend on them
    by_inputs: Array


@dataclass(frozen=True, eq=False)
class ProgramGradient(Value):
    """Value and gradient of an objective."""

    #: the objective: the sum over the steps
    value: float
    #: (steps, measures) SI
    values: Array
    #: of the robot and its surroundings
    parameters: list[Parameter]
    #: (parameters,)
    by_parameters: Array
    #: (nodes, 3) with respect to the rest positions of the nodes, if requested; otherwise (0, 3). Markers, guide
    #: points, springs and masses move along with the mesh; prescribed lengths and volumes change
    #: with their rest values: by the same amount where the target in the robot file is `shortening` or
    #: `volume_change`, otherwise in proportion
    by_rest_positions: Array
    #: of cables, then of springs; if requested
    guide_points: list[GuidePoint]
    #: (guide_points, 3) with respect to the rest position of each
    by_guide_points: Array
    #: if requested
    by_tets: list[TetGradient]
    #: (numbers,) in the units of the robot file
    by_numbers: Array
    #: inputs of the robot; their values are those at rest
    inputs: list[Parameter]
    #: in chronological order
    instants: list[Instant]


def gradient(
    model: Model,
    measures: Iterable[Measure],
    judge: Judge,
    *,
    rest_positions: bool = False,
    guide_points: bool = False,
    tets: bool = False,
    numbers: Iterable[str] = (),
    kept: int = 8,
    progress: Progress | None = None,
) -> ProgramGradient:
    """Runs the robot's program and differentiates it backwards, with the adjoint of each step; also for a motion in
    time.

    The objective is the sum over the steps, from 1, of the cost that `judge` gives for the measured values::

        tip = pliant.Measure("marker", "tip", (0, 0, 1))
        found = pliant.gradient(model, [tip], lambda step, values: (values[0] ** 2, 2 * values))

    Slopes of zero give a gradient of zeros.

    Lagged quantities are held constant: the normal forces and tangents of contact friction, the tension shares of
    cables with friction, contact and joint stiffness that are derived from a material's modulus and, for derivatives by
    rest positions, areas of contact. The gradient is exact for the problem with these quantities held constant, and
    may differ there from finite differences of the whole program.

    Args:
        model: a model of a robot with a program.
        measures: the values passed to `judge`.
        judge: called at least once per step, in any order; must be deterministic.
        rest_positions: also differentiate with respect to the rest positions of the nodes.
        guide_points: also with respect to the guide points of cables and springs; gap elements that a cable acts
            through are unchanged.
        tets: also with respect to the material of each tetrahedron.
        numbers: names of [parameters] of the robot file that are numbers, not formulas of others: also with respect to
            these. Everything that follows from one is included: the shape, whose mesh moves along, positions,
            constants, targets. Only for quasi-static programs without friction and objects, in which supports hold every
            body.
        kept: number of states kept if steps depend on earlier ones; the others are solved again.
        progress: called with (stage, share) some times a second; False cancels.

    Raises:
        Failure: a measure or number does not exist, or a step does not converge or has no derivative.
    """
    owned = _check.instance(model, Model, "model")
    listed = _check.several(measures, Measure, "measures")
    if not listed:
        raise InputError('measures is empty; name what is measured, as Measure("tension", "flexor")')
    names = _check.texts(numbers, "numbers")
    if not callable(judge):
        raise TypeError(f"judge must be callable, as judge(step, values), not {type(judge).__name__}")

    def judged(step: int, values: Array) -> tuple[float, list[float]]:
        said = judge(step, values)
        if not isinstance(said, tuple) or len(said) != 2:
            raise InputError("judge must give a number and its slopes, as (value, slopes)")
        slopes = _check.finite(said[1], "the slopes of judge", (len(listed),))
        return _check.number(said[0], "the value of judge"), slopes.tolist()

    with owned.robot._in_its_words():
        found: dict[str, Any] = _pliant.program_gradient(
            owned._model,
            [m._tuple() for m in listed],
            judged,
            bool(rest_positions),
            bool(guide_points),
            bool(tets),
            names,
            _check.integer(kept, "kept"),
            _check.progress(progress),
        )
    found["values"] = np.array(found["values"]).reshape(-1, len(listed))
    found["parameters"] = [Parameter(*p) for p in found["parameters"]]
    found["guide_points"] = [GuidePoint(name, (x, y, z)) for name, (x, y, z) in found["guide_points"]]
    found["inputs"] = [Parameter(*p) for p in found["inputs"]]
    found["by_tets"] = [TetGradient(*t) for t in found["by_tets"]]
    found["instants"] = [Instant(*i) for i in found["instants"]]
    return ProgramGradient(**found)
