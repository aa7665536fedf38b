"""What is read off a state. SI units throughout."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from ._check import Array


class Cable(NamedTuple):
    """A cable of an :class:`Observation`."""

    #: m, along all its points
    length_m: float
    #: of that at rest
    length_ratio: float
    #: N, never negative
    tension_N: float


class Chamber(NamedTuple):
    """A chamber of an :class:`Observation`."""

    #: m^3, inside its walls
    volume_m3: float
    #: of that at rest
    volume_ratio: float
    #: Pa, above ambient
    pressure_Pa: float


class Spring(NamedTuple):
    """A spring of an :class:`Observation`."""

    #: m, between its ends
    length_m: float
    #: N, positive where it pulls
    force_N: float


class Joint(NamedTuple):
    """A joint of an :class:`Observation`."""

    #: (3,) N, of the first of the two things on the second
    force_N: Array
    #: (3,) N m, likewise, about the joint
    torque_Nm: Array
    #: angle of a hinge, rad, with whole turns; place of a slider, m; else 0
    coordinate: float
    #: what drives, holds and damps along it, N m or N
    effort: float


class Object(NamedTuple):
    """A rigid object of an :class:`Observation`."""

    #: (3,) m, of its centre of mass
    position_m: Array
    #: (4,) from where it started: unit quaternion w, x, y, z with w >= 0
    rotation: Array
    #: (3,) N, pressure and friction of all that touches it
    force_N: Array


@dataclass(frozen=True)
class Observation:
    """What can be read off a state, by the names of the robot file."""

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
    #: by name of the obstacle: (3,) pressure and friction on the robot, N
    contacts: dict[str, Array]
    #: by name: what a [[sensor]] reads, by name of the reading, in SI units
    sensors: dict[str, dict[str, float]]
    #: by name
    joints: dict[str, Joint]
    #: by name
    objects: dict[str, Object]
    #: N, sum of the sizes of the robot's forces on itself
    self_contact_N: float
    #: m, between surfaces that are near enough to act; infinite where none are
    smallest_distance_m: float
    #: J, elastic and contact energy, minus the work of loads and gravity
    energy_J: float
    #: J, of a motion in time
    kinetic_energy_J: float
    #: smallest ratio of volumes, now over rest, of any point
    min_J: float


@dataclass(frozen=True)
class Fields:
    """(tets,) one value for each tetrahedron: the mean over its integration points."""

    #: det F
    volume_ratio: Array
    #: of the Cauchy stress, Pa
    von_mises_Pa: Array
    #: largest principal stretch
    max_stretch: Array
    #: J/m^3 of rest volume; 0 where the law has no energy
    energy_density_Pa: Array


def observation(seen: dict[str, Any]) -> Observation:
    """From what the extension gives."""
    named: dict[str, Any] = {
        "cables": {name: Cable(*c) for name, c in seen["cables"].items()},
        "chambers": {name: Chamber(*c) for name, c in seen["chambers"].items()},
        "springs": {name: Spring(*s) for name, s in seen["springs"].items()},
        "joints": {name: Joint(*j) for name, j in seen["joints"].items()},
        "objects": {name: Object(*o) for name, o in seen["objects"].items()},
    }
    return Observation(**{**seen, **named})
