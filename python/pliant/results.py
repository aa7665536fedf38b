"""Measurable quantities of a state. SI units throughout."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from ._check import Array
from ._values import Value, value_tuple


class Cable(NamedTuple):
    """A cable of an :class:`Observation`."""

    #: m, along the whole cable
    length_m: float
    #: length over rest length
    length_ratio: float
    #: N, never negative
    tension_N: float


class Chamber(NamedTuple):
    """A chamber of an :class:`Observation`."""

    #: m^3, enclosed by its walls
    volume_m3: float
    #: volume over rest volume
    volume_ratio: float
    #: Pa, above ambient
    pressure_Pa: float


class Spring(NamedTuple):
    """A spring of an :class:`Observation`."""

    #: m, between its ends
    length_m: float
    #: N, positive where it pulls
    force_N: float


@value_tuple
class Joint(NamedTuple):
    """A joint of an :class:`Observation`."""

    #: (3,) N, from the first connected part on the second
    force_N: Array
    #: (3,) N m, likewise, about the joint
    torque_Nm: Array
    #: hinge: angle with whole turns, rad; slider: displacement, m; otherwise 0
    coordinate: float
    #: drive, hold and damping along it, N m or N
    effort: float


@value_tuple
class Object(NamedTuple):
    """A rigid object of an :class:`Observation`."""

    #: (3,) m, of the centre of mass
    position_m: Array
    #: (4,) since the start: unit quaternion w, x, y, z with w >= 0
    rotation: Array
    #: (3,) N, normal force and friction of everything that touches it
    force_N: Array


@dataclass(frozen=True, eq=False)
class Observation(Value):
    """Measurable quantities of a state, by the names of the robot file. Two are equal if all numbers are."""

    #: by name
    cables: dict[str, Cable]
    #: by name
    chambers: dict[str, Chamber]
    #: by name
    springs: dict[str, Spring]
    #: by name: (3,) position, m
    markers: dict[str, Array]
    #: by name: (3,) reaction on the robot, N
    supports: dict[str, Array]
    #: by name of the obstacle: (3,) normal force and friction on the robot, N
    contacts: dict[str, Array]
    #: by name of the [[sensor]]: its readings by their names, in SI units
    sensors: dict[str, dict[str, float]]
    #: by name
    joints: dict[str, Joint]
    #: by name
    objects: dict[str, Object]
    #: N, sum of the magnitudes of the self-contact forces
    self_contact_N: float
    #: m, smallest distance between surfaces within contact range; infinite if there are none
    smallest_distance_m: float
    #: J, elastic and contact energy, minus the work of loads and gravity
    energy_J: float
    #: J, of a motion in time, otherwise 0
    kinetic_energy_J: float
    #: smallest J = det F over all integration points
    min_J: float


@dataclass(frozen=True, eq=False)
class Fields(Value):
    """(tets,) one value for each tetrahedron: the mean over its integration points."""

    #: det F
    volume_ratio: Array
    #: of the Cauchy stress, Pa
    von_mises_Pa: Array
    #: largest principal stretch
    max_stretch: Array
    #: J per m^3 of rest volume; 0 where the law has no energy
    energy_density_Pa: Array


def observation(seen: dict[str, Any]) -> Observation:
    """From the dict of the extension."""
    named: dict[str, Any] = {
        "cables": {name: Cable(*c) for name, c in seen["cables"].items()},
        "chambers": {name: Chamber(*c) for name, c in seen["chambers"].items()},
        "springs": {name: Spring(*s) for name, s in seen["springs"].items()},
        "joints": {name: Joint(*j) for name, j in seen["joints"].items()},
        "objects": {name: Object(*o) for name, o in seen["objects"].items()},
    }
    return Observation(**{**seen, **named})
