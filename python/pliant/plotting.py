"""Pictures of robots with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Union

import numpy as np
import numpy.typing as npt

from . import _check
from ._check import Array
from .errors import InputError
from .model import Model, State

if TYPE_CHECKING:
    from .program import ProgramResult

#: Fields that a robot can be coloured by: label, unit and factor to that unit.
FIELDS = {
    "displacement": ("displacement", "mm", 1e3),
    "von_mises": ("von Mises stress", "kPa", 1e-3),
    "stretch": ("largest stretch", "", 1.0),
    "J": ("volume ratio J", "", 1.0),
    "energy": ("strain energy density", "kJ/m³", 1e-3),
}
# Colours of regions that are told apart with the common colour vision deficiencies.
_PALETTE = ["#e07a5f", "#3d6b9e", "#81b29a", "#f2cc8f", "#8d6a9f", "#5f9ea0", "#b56576", "#6d6875"]


def plot(
    what: Union[Model, State], *, field: str | None = None, ax: Any = None, edges: bool = False, view: Any = (25, -60)
) -> Any:
    """Draws a model at rest or a state in 3D, in mm.

    Args:
        what: a model or a state.
        field: None: colours of the bodies; "displacement", "von_mises", "stretch", "J" or "energy".
        ax: axes with ``projection="3d"``; None: new ones.
        edges: draw the edges of the mesh.
        view: elevation and azimuth in degrees.

    Returns:
        The axes.
    """
    state = _state(what)
    if ax is not None and not hasattr(ax, "get_zlim"):
        raise InputError(f'ax must be axes with projection="3d", not {type(ax).__name__}')
    angles = _check.finite(view, "view", (2,))
    if field is not None:
        _check.one_of(field, FIELDS, "field")
    plt = _pyplot()
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    axes = plt.figure().add_subplot(projection="3d") if ax is None else ax
    axes.computed_zorder = False  # cables and markers are seen through the body
    triangles = state.model.surface()
    corners = 1e3 * state.positions[triangles]
    colours, values = _colours(state, triangles, field)
    body = Poly3DCollection(
        corners,
        facecolors=_shaded(corners, colours),
        edgecolors="#10151c40" if edges else "none",
        linewidths=0.3 if edges else 0,
    )
    axes.add_collection3d(body)
    for path in state.model.cable_paths(state).values():
        axes.plot(*(1e3 * path).T, color="#cc1a24", linewidth=1.5, zorder=5)
    markers = 1e3 * state.markers()
    if len(markers):
        axes.scatter(*markers.T, color="#11161d", s=14, depthshade=False, zorder=6)
    _frame(axes, corners.reshape(-1, 3), angles)
    if values is not None and field is not None:
        _colour_bar(axes, values, field)
    return axes


def plot_program(result: ProgramResult, *, axes: Any = None) -> Any:
    """Plots the motion of markers, and tensions and pressures, over the time of a program.

    Returns:
        Two axes, one above the other.
    """
    from .program import ProgramResult

    _check.instance(result, ProgramResult, "result")
    if axes is not None and (np.shape(axes) != (2,) or not all(hasattr(a, "plot") for a in axes)):
        raise InputError("axes must be two axes, one for markers and one for tensions and pressures")
    plt = _pyplot()
    upper, lower = plt.subplots(2, 1, sharex=True, layout="constrained")[1] if axes is None else axes
    times = result.times
    for name, way in result.markers.items():
        upper.plot(times, 1e3 * np.linalg.norm(way - way[0], axis=1), label=name)
    upper.set_ylabel("motion of markers (mm)")
    seen = [step.observed for step in result]
    for name in result.model.cables:
        lower.plot(times, [s.cables[name].tension_N for s in seen], label=f"{name} (N)")
    for name in result.model.chambers:
        lower.plot(times, [1e-3 * s.chambers[name].pressure_Pa for s in seen], label=f"{name} (kPa)")
    lower.set_ylabel("tension, pressure")
    lower.set_xlabel("time of the program (s)")
    for axes_ in (upper, lower):
        axes_.grid(alpha=0.3)
        if axes_.get_legend_handles_labels()[1]:
            axes_.legend()
    return upper, lower


def picture(what: Union[Model, State], *, field: str | None = None, size_px: tuple[int, int] = (640, 480)) -> Any:
    """(height, width, 3) bytes: the robot as :func:`plot` draws it, without a window."""
    sizes = _check.integers(size_px, "size_px")
    if sizes.shape != (2,):
        raise InputError("size_px must be two whole numbers, width and height")
    width, height = (int(s) for s in sizes)
    if not (16 <= width <= 10000 and 16 <= height <= 10000):
        raise InputError(f"a picture of {width} x {height} pixels is not possible; write 16 to 10000 for each")
    _pyplot()
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width / 100, height / 100), dpi=100, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    plot(what, field=field, ax=figure.add_subplot(projection="3d"))
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[:, :, :3].copy()


def _pyplot() -> Any:
    try:
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise ImportError("pictures need matplotlib (Debian: python3-matplotlib)") from error
    return plt


def _state(what: Any) -> State:
    if isinstance(what, Model):
        return what.rest()
    if isinstance(what, State):
        return what
    raise TypeError(f"what is drawn must be a pliant.Model or a pliant.State, not {type(what).__name__}")


def field_values(state: State, field: str) -> Array:
    """(tets,) values of one of FIELDS, in the unit of its label."""
    _check.one_of(field, FIELDS, "field")
    scale = FIELDS[field][2]
    if field == "displacement":
        away = np.linalg.norm(state.displacements, axis=1)
        return scale * np.asarray(away[state.model.tets[:, :4]].mean(axis=1))
    fields = state.fields()
    values = {
        "von_mises": fields.von_mises_Pa,
        "stretch": fields.max_stretch,
        "J": fields.volume_ratio,
        "energy": fields.energy_density_Pa,
    }[field]
    return scale * values


def _tet_of_face(state: State, triangles: npt.NDArray[np.int32]) -> npt.NDArray[np.int64]:
    """(triangles,) the tetrahedron that each belongs to."""
    corners = state.model.tets[:, :4]
    faces = np.sort(np.concatenate([corners[:, f] for f in ([0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3])]), axis=1)
    count = state.model.node_count
    key = np.array([count * count, count, 1], dtype=np.int64)
    keys = faces @ key
    order = np.argsort(keys, kind="stable")
    found = order[np.searchsorted(keys[order], np.sort(triangles, axis=1) @ key)]
    return np.asarray(found % len(corners), dtype=np.int64)


def _colours(state: State, triangles: npt.NDArray[np.int32], field: str | None) -> tuple[Any, Array | None]:
    from matplotlib import colormaps
    from matplotlib.colors import to_rgb

    tets = _tet_of_face(state, triangles)
    if field is None:
        palette = np.array([to_rgb(c) for c in _PALETTE])
        return palette[state.model.regions[tets] % len(palette)], None
    values = field_values(state, field)
    shown = values[tets]
    low, high = float(shown.min()), float(shown.max())
    share = (shown - low) / (high - low) if high > low else np.zeros(len(shown))
    return colormaps["viridis"](share)[:, :3], shown


def _shaded(corners: Array, colours: Any) -> Any:
    """Lit from above, so that shapes can be seen."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    light = (normals / np.where(length > 0, length, 1)) @ (np.array([0.35, -0.5, 0.8]) / np.linalg.norm([0.35, -0.5, 0.8]))
    return np.clip(colours * (0.72 + 0.28 * light)[:, None], 0, 1)


def _frame(axes: Any, points: Array, view: Any) -> None:
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.02 * float((high - low).max())
    for set_limits, a, b in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), low - margin, high + margin):
        set_limits(a, b)
    axes.set_box_aspect(high - low + 2 * margin)
    for axis, extent in zip((axes.xaxis, axes.yaxis, axes.zaxis), (high - low) / (high - low).max()):
        axis.get_major_locator().set_params(nbins=max(1, round(6 * float(extent))))
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("y (mm)")
    axes.set_zlabel("z (mm)")
    axes.view_init(*view)


def _colour_bar(axes: Any, values: Array, field: str) -> None:
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    name, unit, _ = FIELDS[field]
    mapped = ScalarMappable(Normalize(float(values.min()), float(values.max())), colormaps["viridis"])
    axes.figure.colorbar(mapped, ax=axes, label=f"{name} ({unit})" if unit else name, shrink=0.7)
