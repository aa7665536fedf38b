"""Robots for the tests."""

from __future__ import annotations

from typing import Any

import numpy as np

import pliant

#: A bar of 60 mm with a cable along its upper side.
BAR: dict[str, Any] = {
    "name": "bar",
    "length_unit": "mm",
    "material": {"soft": {"youngs_modulus": "1 MPa", "poisson_ratio": 0.45, "density": "1100 kg/m^3"}},
    "mesh": {"order": 1, "size": "5 mm"},
    "body": [{"name": "bar", "material": "soft", "geometry": {"box": [[0, 0, 0], [60, 10, 10]]}}],
    "fixed": [{"name": "clamp", "box": [[0, 0, 0], [0, 10, 10]]}],
    "marker": [{"name": "tip", "point": [60, 5, 5]}],
    "cable": [{"name": "flexor", "points": [[0, 5, 9], [30, 5, 9], [60, 5, 9]], "target": {"shortening": "4 mm"}}],
    "program": {"steps": 4},
}

#: A block of 10 mm whose mesh is made here.
BLOCK: dict[str, Any] = {
    "name": "block",
    "length_unit": "mm",
    "material": {"soft": {"youngs_modulus": "1 MPa", "poisson_ratio": 0.3}},
    "mesh": {"file": "memory:", "order": 1},
    "body": [{"name": "block", "material": "soft", "region": "all"}],
    "fixed": [{"name": "bottom", "box": [[0, 0, 0], [10, 10, 0]]}],
    "load": [{"name": "push", "box": [[0, 0, 10], [10, 10, 10]], "force": ["0 N", "0 N", "-0.1 N"]}],
    "marker": [{"name": "top", "point": [5, 5, 10]}],
    "cable": [{"name": "side", "points": [[5, 0, 0], [5, 0, 10]], "anchor": "first", "target": {"length_ratio": 0.9}}],
}


def cube() -> pliant.Mesh:
    """Of 10 mm, in six tets around a diagonal."""
    points = [[0.01 * (k & 1), 0.01 * (k >> 1 & 1), 0.01 * (k >> 2)] for k in range(8)]
    tets = [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]]
    return pliant.Mesh(np.array(points), np.array(tets))


def bar(**changes: Any) -> pliant.Model:
    """The bar, meshed; keyword arguments take the place of its tables."""
    return pliant.Model(pliant.Robot({**BAR, **changes}))


def block() -> pliant.Model:
    """The block on its mesh: quick to make."""
    return pliant.Model(pliant.Robot(BLOCK), cube())
