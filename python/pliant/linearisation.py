"""What a state answers to small changes: of what drives the robot, of what it is made of, of its rest shape."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _check, _pliant
from ._check import Array
from .errors import InputError

if TYPE_CHECKING:
    from .model import State


class Parameter(NamedTuple):
    """A number that a state is a function of."""

    #: for people: cable "left": length
    name: str
    #: SI; "" for a plain number
    unit: str
    #: at the state
    value: float


class GuidePoint(NamedTuple):
    """A point that a cable or spring goes through."""

    #: for people: cable "left": point 2
    name: str
    #: (3,) at rest, m
    place: tuple[float, float, float]


class Measure(NamedTuple):
    """Something that can be measured on a robot: one number, in SI units.

    ============= ================================================================ ====
    of            what it is                                                       unit
    ============= ================================================================ ====
    marker        its coordinate along `direction`                                 m
    tension       of a cable                                                       N
    pressure      of a chamber or a load that presses                              Pa
    length        of a cable                                                       m
    length_ratio  of a cable, over that at rest
    volume        of a chamber                                                     m^3
    volume_ratio  of a chamber, over that at rest
    spring_length of a spring                                                      m
    spring_force  of a spring, positive where it pulls                             N
    reaction      force of a support on the robot along `direction`                N
    contact_force force of an obstacle on the robot along `direction`, friction in N
    self_contact  sum of the sizes of the robot's normal forces on itself; no name N
    ============= ================================================================ ====
    """

    of: str
    #: on which, as in the robot file
    name: str = ""
    #: (3,) of any length
    direction: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def _tuple(self) -> tuple[str, str, list[float]]:
        if not isinstance(self.of, str) or not isinstance(self.name, str):
            raise TypeError('a Measure is made of texts, as Measure("marker", "tip", (0, 0, 1))')
        return self.of, self.name, _check.numbers(self.direction, "direction", (3,)).tolist()


@dataclass(frozen=True)
class Change:
    """A small change of a state, for each unit of what causes it."""

    #: (nodes, 3) m
    positions: Array
    #: (cables,) N
    tensions: Array
    #: (chambers,) Pa
    pressures: Array


@dataclass(frozen=True)
class Gradient:
    """What everything does to a number that depends on a state, for each SI unit."""

    #: (cables + chambers,) by the controls, in the kinds of the state
    controls: Array
    #: (inputs,) by :attr:`Linearisation.inputs`: controls, and shares of supports, loads, gravity and obstacles
    inputs: Array
    #: (parameters,) by :attr:`Linearisation.parameters`
    parameters: Array
    #: (nodes, 3) by the rest shape; lengths and volumes that are driven stay as they are, in m and m^3
    rest_positions: Array
    #: (guide points, 3) by where each of :attr:`Linearisation.guide_points` is at rest, where wanted; else (0, 3)
    guide_points: Array


class Linearisation:
    """The equations of a state of equilibrium, F(z) = 0 in its unknowns z, linearised with everything that acts.

    The unknowns are the positions of the nodes that nothing holds, three by three, then the multipliers that are not
    given: tensions of cables and minus the pressures of chambers. The matrix is factorised at the first solution and
    kept. Threads that share one wait for each other.

    Args:
        state: one that a step left; a copy is kept.
    """

    __slots__ = ("model", "_at", "_inputs", "_columns")

    def __init__(self, state: State) -> None:
        from .model import State as StateClass

        _check.instance(state, StateClass, "state")
        self.model = state.model
        self._at = _pliant.Linearisation(state._state)
        self._inputs = [Parameter(*p) for p in self._at.inputs()]
        self._columns = self._actuator_columns()

    def _actuator_columns(self) -> list[int]:
        """Of each cable and chamber its input; -1: it has none, as thesis' elements."""
        places = {p.name.rsplit(": ", 1)[0]: k for k, p in reversed(list(enumerate(self._inputs)))}
        heads = [f'cable "{name}"' for name in self.model.cables] + [f'chamber "{n}"' for n in self.model.chambers]
        return [places.get(head, -1) for head in heads]

    @property
    def size(self) -> int:
        """Unknowns."""
        return self._at.size

    def multiply(self, v: Any) -> Array:
        """(unknowns,) A v with A = dF/dz. Exact."""
        return self._at.multiply(self._vector(v, "v"))

    def multiply_transposed(self, w: Any) -> Array:
        """(unknowns,) A^T w."""
        return self._at.multiply_transposed(self._vector(w, "w"))

    def solve(self, b: Any) -> Array:
        """(unknowns,) A^-1 b, to 1e-12 of b; also where the equilibrium is unstable."""
        return self._at.solve(self._vector(b, "b"))

    def solve_transposed(self, b: Any) -> Array:
        """(unknowns,) A^-T b."""
        return self._at.solve_transposed(self._vector(b, "b"))

    def change(self, unknowns: Any) -> Change:
        """What a vector of unknowns is, as a change of the state."""
        return Change(*self._at.change(self._vector(unknowns, "unknowns")))

    @property
    def inputs(self) -> list[Parameter]:
        """What drives the robot: controls, and how far supports, loads, gravity and obstacles are on their way."""
        return list(self._inputs)

    @property
    def parameters(self) -> list[Parameter]:
        """What the robot is made of and stands in: constants of materials, densities, springs, friction, loads..."""
        return [Parameter(*p) for p in self._at.parameters()]

    @property
    def guide_points(self) -> list[GuidePoint]:
        """What cables go through, then springs. With guides at crossings those count, too."""
        return [GuidePoint(name, (x, y, z)) for name, (x, y, z) in self._at.guide_points()]

    def response(self, input: int | str) -> Change:
        """What the whole state does for each unit of an input, by its name or index. One solution."""
        return Change(*self._at.response_to_input(self._index(input, self._inputs, "input")))

    def response_to_parameter(self, parameter: int | str) -> Change:
        """What the whole state does for each unit of a parameter, by its name or index. One solution."""
        return Change(*self._at.response_to_parameter(self._index(parameter, self.parameters, "parameter")))

    def jacobian(self, markers: Iterable[str] | None = None) -> Array:
        """(markers, 3, cables + chambers) how markers move with each control: m for each SI unit of its kind."""
        names = self.model.markers if markers is None else _check.texts(markers, "markers")
        driven = [c for c in self._columns if c >= 0]
        found = self._at.jacobian([self._marker(name) for name in names], driven)
        if len(driven) == len(self._columns):
            return found
        full = np.zeros((len(names), 3, len(self._columns)))
        full[:, :, [k for k, c in enumerate(self._columns) if c >= 0]] = found
        return full

    def gradient(
        self,
        *,
        positions: Any = None,
        tensions: Any = None,
        pressures: Any = None,
        markers: Mapping[str, Any] | None = None,
        guide_points: bool = False,
    ) -> Gradient:
        """As of :meth:`Model.grad`."""
        model = self.model
        by = np.zeros((model.node_count, 3))
        if positions is not None:
            by += _check.numbers(positions, "positions", (model.node_count, 3))
        if markers is not None and not isinstance(markers, Mapping):
            raise TypeError('markers must be a mapping, as {"tip": [0, 0, 1]}')
        for name, weights in (markers or {}).items():
            index, direction = self._marker(name), _check.numbers(weights, f"markers[{name!r}]", (3,))
            by += self._at.marker_coordinate(index, direction.tolist())
        found = self._at.gradient(
            by,
            _vector_or_none(tensions, "tensions", len(model.cables)),
            _vector_or_none(pressures, "pressures", len(model.chambers)),
            bool(guide_points),
        )
        return self._gradient(*found)

    def value(self, measure: Measure) -> float:
        """The number at this state."""
        return self._at.value(_check.instance(measure, Measure, "measure")._tuple())

    def gradient_of(self, measure: Measure, *, guide_points: bool = False) -> Gradient:
        """Derivatives of what is measured. Unlike :meth:`gradient` it knows what the measure itself has of a parameter,
        and with the rest shape and guide points lengths and volumes that are wanted as a share of what they are at rest
        follow."""
        wanted = _check.instance(measure, Measure, "measure")._tuple()
        return self._gradient(*self._at.gradient_of(wanted, bool(guide_points)))

    def _gradient(self, inputs: Array, parameters: Array, rest: Array, guides: Array) -> Gradient:
        controls = np.array([inputs[c] if c >= 0 else 0.0 for c in self._columns], dtype=np.float64)
        return Gradient(controls, inputs, parameters, rest, guides)

    def _vector(self, v: Any, what: str) -> Array:
        return _check.numbers(v, what, (self.size,))

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
    return np.empty(0) if value is None else _check.numbers(value, what, (size,))
