"""Derivatives of a state of equilibrium with respect to inputs, parameters and the rest shape."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, Union

import numpy as np

from . import _check, _pliant
from ._check import AnyArray, Array
from ._values import NotPickled, Value, value_tuple
from .errors import InputError

if TYPE_CHECKING:
    from .model import State


class Parameter(NamedTuple):
    """A number that the state depends on."""

    #: for people, such as: cable "left": length
    name: str
    #: SI; "" if dimensionless
    unit: str
    #: its value at the state
    value: float


class GuidePoint(NamedTuple):
    """A guide point of a cable or spring."""

    #: for people, such as: cable "left": point 2
    name: str
    #: (3,) rest position, m
    place: tuple[float, float, float]


@value_tuple
class Measure(NamedTuple):
    """A scalar that can be measured on a robot, in SI units.

    ============= ================================================================ ====
    of            measured quantity                                                unit
    ============= ================================================================ ====
    marker        its coordinate along `direction`                                 m
    tension       of a cable                                                       N
    pressure      of a chamber or a pressure load                                  Pa
    length        of a cable                                                       m
    length_ratio  length of a cable over its rest length
    volume        of a chamber                                                     m^3
    volume_ratio  volume of a chamber over its rest volume
    spring_length of a spring                                                      m
    spring_force  of a spring, positive where it pulls                             N
    reaction      force of a support on the robot along `direction`                N
    contact_force force of an obstacle on the robot along `direction`, with        N
                  friction
    self_contact  sum of the magnitudes of the robot's normal forces on itself;    N
                  needs no name
    ============= ================================================================ ====
    """

    of: str
    #: what it is measured on, as in the robot file
    name: str = ""
    #: (3,) of a marker, reaction or contact force; not zero. The value is the dot product with it: value and gradient
    #: scale with its length
    direction: Union[Sequence[float], AnyArray] = (0.0, 0.0, 0.0)

    def _tuple(self) -> tuple[str, str, list[float]]:
        if not isinstance(self.of, str) or not isinstance(self.name, str):
            raise TypeError('a Measure is made of texts, as Measure("marker", "tip", (0, 0, 1))')
        return self.of, _check.text(self.name, "name"), _check.finite(self.direction, "direction", (3,)).tolist()


@dataclass(frozen=True, eq=False)
class Change(Value):
    """First-order change of a state, per unit of its cause."""

    #: (nodes, 3) m
    positions: Array
    #: (cables,) N
    tensions: Array
    #: (chambers,) Pa
    pressures: Array


@dataclass(frozen=True, eq=False)
class Gradient(Value):
    """Derivatives of a function of the state, per SI unit."""

    #: (cables + chambers,) with respect to the controls, of the kinds of the state: the first of `inputs`
    controls: Array
    #: (inputs,) with respect to :attr:`Linearisation.inputs`: controls, and progress of supports, loads, gravity and
    #: obstacles
    inputs: Array
    #: (parameters,) with respect to :attr:`Linearisation.parameters`
    parameters: Array
    #: (nodes, 3) with respect to the rest positions of the nodes. Markers, guide points, springs and masses are
    #: attached to the mesh and move along with it. Prescribed lengths and volumes keep their values in m and m^3,
    #: except in :meth:`Linearisation.gradient_of`
    rest_positions: Array
    #: (guide points, 3) with respect to the rest position of each of :attr:`Linearisation.guide_points`, if requested;
    #: otherwise (0, 3)
    guide_points: Array


class Linearisation(NotPickled):
    """The equilibrium equations F(z) = 0, linearised at a state: elements, cables and chambers, follower pressure,
    contact, friction as found at the state, inertia.

    The unknowns z are the coordinates of the unconstrained nodes, three for each, followed by the multipliers that are
    not prescribed: cable tensions and minus the chamber pressures. The first solve factorises the matrix, which is then
    kept. Threads may share a Linearisation; one at a time uses it.

    In a motion in time the equations are those of the last step: the state before it is held constant, its positions
    and velocities, also in derivatives with respect to a parameter that acted on it. :func:`pliant.gradient`
    differentiates the whole motion. Other quantities that are held constant: see there.

    Args:
        state: a state returned by a step; a copy is kept.
    """

    __slots__ = ("model", "_at", "_inputs")
    _instead = "pickle its state, and linearise that again"

    def __init__(self, state: State) -> None:
        from .model import State as StateClass

        _check.instance(state, StateClass, "state")
        self.model = state.model
        self._at = _pliant.Linearisation(state._state)
        self._inputs = [Parameter(*p) for p in self._at.inputs()]

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self._at.size

    def multiply(self, v: Any) -> Array:
        """(unknowns,) the product A v with the exact tangent A = dF/dz."""
        return self._at.multiply(self._vector(v, "v"))

    def multiply_transposed(self, w: Any) -> Array:
        """(unknowns,) the product A^T w."""
        return self._at.multiply_transposed(self._vector(w, "w"))

    def solve(self, b: Any) -> Array:
        """(unknowns,) A^-1 b, as accurate as rounding allows; also at an unstable equilibrium."""
        return self._at.solve(self._vector(b, "b"))

    def solve_transposed(self, b: Any) -> Array:
        """(unknowns,) A^-T b, as accurate as :meth:`solve`."""
        return self._at.solve_transposed(self._vector(b, "b"))

    def change(self, unknowns: Any) -> Change:
        """Translates a vector of unknowns into a change of the state."""
        return Change(*self._at.change(self._vector(unknowns, "unknowns")))

    @property
    def inputs(self) -> list[Parameter]:
        """The inputs: one for each cable, one for each chamber, then pressure loads and the progress of supports,
        loads, gravity and obstacles along their program."""
        return list(self._inputs)

    @property
    def parameters(self) -> list[Parameter]:
        """The parameters of the robot and its surroundings: material constants, densities, springs, friction,
        loads..."""
        return [Parameter(*p) for p in self._at.parameters()]

    @property
    def guide_points(self) -> list[GuidePoint]:
        """The guide points of all cables, followed by those of all springs, including guide points at crossings."""
        return [GuidePoint(name, (x, y, z)) for name, (x, y, z) in self._at.guide_points()]

    def response(self, input: int | str) -> Change:
        """Derivative of the whole state with respect to one input, given by name or index. One linear solve."""
        return Change(*self._at.response_to_input(self._index(input, self._inputs, "input")))

    def response_to_parameter(self, parameter: int | str) -> Change:
        """Derivative of the whole state with respect to one parameter, given by name or index. One linear solve."""
        return Change(*self._at.response_to_parameter(self._index(parameter, self.parameters, "parameter")))

    def jacobian(self, markers: Iterable[str] | None = None) -> Array:
        """As :meth:`Model.jacobian`."""
        names = self.model.markers if markers is None else _check.texts(markers, "markers")
        return self._at.jacobian([self._marker(name) for name in names], list(range(len(self.model.actuators))))

    def gradient(
        self,
        *,
        positions: Any = None,
        tensions: Any = None,
        pressures: Any = None,
        markers: Mapping[str, Any] | None = None,
        guide_points: bool = False,
    ) -> Gradient:
        """As :meth:`Model.grad`."""
        model = self.model
        by = np.zeros((model.node_count, 3))
        if positions is not None:
            by += _check.finite(positions, "positions", (model.node_count, 3))
        if markers is not None and not isinstance(markers, Mapping):
            raise TypeError('markers must be a mapping, as {"tip": [0, 0, 1]}')
        for name, weights in (markers or {}).items():
            index, direction = self._marker(name), _check.finite(weights, f"markers[{name!r}]", (3,))
            by += self._at.marker_coordinate(index, direction.tolist())
        found = self._at.gradient(
            by,
            _vector_or_none(tensions, "tensions", len(model.cables)),
            _vector_or_none(pressures, "pressures", len(model.chambers)),
            bool(guide_points),
        )
        return self._gradient(*found)

    def value(self, measure: Measure) -> float:
        """The value of a measure at this state."""
        return self._at.value(_check.instance(measure, Measure, "measure")._tuple())

    def gradient_of(self, measure: Measure, *, guide_points: bool = False) -> Gradient:
        """Gradient of a measure, by one transposed solve.

        It differs from :meth:`gradient` in two ways. A parameter that the measure itself depends on counts with that
        too. And where the rest shape or a guide point changes, prescribed lengths and volumes change with their rest
        values: by the same amount where the target in the robot file is `shortening` or `volume_change`, otherwise in
        proportion.
        """
        wanted = _check.instance(measure, Measure, "measure")._tuple()
        return self._gradient(*self._at.gradient_of(wanted, bool(guide_points)))

    def _gradient(self, inputs: Array, parameters: Array, rest: Array, guides: Array) -> Gradient:
        return Gradient(inputs[: len(self.model.actuators)].copy(), inputs, parameters, rest, guides)

    def _vector(self, v: Any, what: str) -> Array:
        return _check.finite(v, what, (self.size,))

    def _marker(self, name: str) -> int:
        if isinstance(name, str) and name in self.model.markers:
            return self.model.markers.index(name)
        there = ", ".join(self.model.markers) or "none"
        raise InputError(f"there is no marker {name!r}; there are {there}", key=str(name))

    @staticmethod
    def _index(wanted: int | str, all: list[Parameter], what: str) -> int:
        if isinstance(wanted, str):
            for k, parameter in enumerate(all):
                if parameter.name == wanted:
                    return k
            raise InputError(f"there is no {what} {wanted!r}; there are {', '.join(p.name for p in all)}", key=wanted)
        index = _check.integer(wanted, what)
        if not 0 <= index < len(all):
            raise InputError(f"there is no {what} {index}; there are {len(all)}")
        return index


def _vector_or_none(value: Any, what: str, size: int) -> Array:
    return np.empty(0) if value is None else _check.finite(value, what, (size,))
