"""How a number that is measured over a whole program changes with everything that it depends on."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Union

import numpy as np

from . import _check, _pliant
from ._check import Array, Progress
from .errors import InputError
from .linearisation import GuidePoint, Measure, Parameter
from .model import Model

#: Called with (step, values): the step from 1 and (measures,) numbers; gives a number and (measures,) its slopes.
Judge = Callable[[int, Array], tuple[float, Union[Array, Sequence[float]]]]


class TetGradient(NamedTuple):
    """By a number that each tetrahedron has, as if each had a material of its own."""

    #: youngs_modulus, c10, density...
    name: str
    #: SI; "" of a plain number
    unit: str
    #: (tets,); 0 where a tetrahedron has no such number
    values: Array


class Instant(NamedTuple):
    """Where an equilibrium was found on the way."""

    #: of the program, from 1
    step: int
    #: of the program
    time: float
    #: (inputs,); empty: nothing depends on them
    by_inputs: Array


@dataclass(frozen=True)
class ProgramGradient:
    """The derivative of what a program is judged by."""

    #: of the objective: the sum over steps
    value: float
    #: (steps, measures) SI
    values: Array
    #: what the robot is made of and stands in
    parameters: list[Parameter]
    #: (parameters,)
    by_parameters: Array
    #: (nodes, 3), where wanted; else (0, 3)
    by_rest_positions: Array
    #: of cables, then of springs; where wanted
    guide_points: list[GuidePoint]
    #: (guide_points, 3) by where each is at rest
    by_guide_points: Array
    #: where wanted
    by_tets: list[TetGradient]
    #: (numbers,) in the units of the robot file
    by_numbers: Array
    #: what drives the robot; values are those at rest
    inputs: list[Parameter]
    #: in the order of time
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
    """Runs the robot's program and goes back over it with the adjoint of each step; also of a motion in time.

    The objective is the sum over the steps, from 1, of what `judge` says of the measured numbers::

        tip = pliant.Measure("marker", "tip", (0, 0, 1))
        found = pliant.gradient(model, [tip], lambda step, values: (values[0] ** 2, 2 * values))

    Args:
        model: of a robot with a program.
        measures: what `judge` is told.
        judge: called once or more for a step, in any order; must say the same each time.
        rest_positions: also by the rest positions of the nodes.
        guide_points: also by where cables and springs are guided; gap elements that a cable acts through stay.
        tets: also by what each tetrahedron is made of.
        numbers: names of [parameters] of the robot file that are numbers, not formulas of others: also by those. What
            follows from one counts: the shape, whose mesh moves along, places, constants, targets. For programs at rest
            without friction.
        kept: states that are kept on the way where steps depend on those before; others are solved again.
        progress: called with (stage, share) some times a second; False cancels.

    Raises:
        Failure: of a measure of something that is not there; where a step does not converge or has no derivative.
    """
    owned = _check.instance(model, Model, "model")
    listed = [_check.instance(m, Measure, "each of measures") for m in measures]
    names = _check.texts(numbers, "numbers")
    if not callable(judge):
        raise TypeError(f"judge must be callable, as judge(step, values), not {type(judge).__name__}")

    def judged(step: int, values: Array) -> tuple[float, list[float]]:
        said = judge(step, values)
        if not isinstance(said, tuple) or len(said) != 2:
            raise InputError("judge must give a number and its slopes, as (value, slopes)")
        slopes = _check.numbers(said[1], "the slopes of judge", (len(listed),))
        return _check.number(said[0], "the value of judge"), slopes.tolist()

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
