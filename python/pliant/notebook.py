"""Robots in a notebook, or in a page of their own: the studio's viewer, offline."""

from __future__ import annotations

import base64
import html
import json
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

from . import _check, _pliant
from ._check import PathLike
from .errors import Failure, InputError
from .model import Model, State
from .results import Observation

if TYPE_CHECKING:
    from .program import ProgramResult

Shown = Union[Model, State, "ProgramResult", Iterable[State]]

_FIELDS = ("material", "displacement", "von_mises", "stretch", "J", "energy")
_STYLE = """
html, body { margin: 0; height: 100%; font: 13px system-ui, sans-serif; color: #1b232d; background: #f4f6f8; }
#viewer { display: flex; flex-direction: column; height: 100%; }
.stage { flex: 1; position: relative; min-height: 0; }
canvas { position: absolute; inset: 0; width: 100%; height: 100%; outline-offset: -2px; }
.bar { display: flex; flex-wrap: wrap; gap: 10px; align-items: center; padding: 6px 10px; background: #fff; }
.bar input[type=range] { flex: 1; min-width: 80px; }
.legend { position: absolute; right: 12px; top: 12px; width: 12px; height: 40%; border-radius: 3px; }
.legend span { position: absolute; right: 17px; white-space: nowrap; }
.legend .high { top: -4px; } .legend .low { bottom: -4px; }
[hidden] { display: none !important; }
"""


class Viewer:
    """A page with the studio's viewer: notebooks show it, :meth:`write` saves it. It needs no network."""

    def __init__(self, page: str, height_px: int) -> None:
        self._page = page
        self._height_px = height_px

    @property
    def page(self) -> str:
        """The whole page as HTML."""
        return self._page

    def write(self, file: PathLike) -> None:
        """Writes the page to a file."""
        path = _check.new_file(file, "file")
        try:
            path.write_text(self._page, encoding="utf-8")
        except OSError as error:
            raise Failure(f"{path}: {error.strerror}", file=str(path)) from None

    def open(self, file: PathLike) -> None:
        """Writes the page and opens it in the browser."""
        import webbrowser

        self.write(file)
        webbrowser.open(Path(file).absolute().as_uri())

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{html.escape(self._page, quote=True)}" style="width: 100%; height: {self._height_px}px; '
            'border: 1px solid #d5dbe1; border-radius: 6px" sandbox="allow-scripts"></iframe>'
        )

    def __repr__(self) -> str:
        return f"<pliant.Viewer of {len(self._page) / 1e6:.1f} MB: shown in a notebook, or kept by write(file)>"


def show(what: Shown, *, field: str = "material", height_px: int = 420) -> Viewer:
    """Shows a robot in a notebook: the studio's viewer, which needs no network.

    Args:
        what: a model (at rest), a state, several states of one model, or the result of a program.
        field: initial colours: "material", "displacement", "von_mises", "stretch", "J" or "energy".
        height_px: height of the frame in the notebook, 16 to 10000.

    Returns:
        A viewer, which a notebook shows as the value of a cell. ``show(state).write("robot.html")`` saves the page.
    """
    _check.one_of(field, _FIELDS, "field")
    height = _check.integer(height_px, "height_px")
    if not 16 <= height <= 10000:
        raise InputError(f"height_px is {height}; it must be from 16 to 10000")
    model, frames = _frames(what)
    shown = {
        "scene": _text(_pliant.View(model._model).scene()),
        "frames": [_text(packet) for packet, _ in frames],
        "labels": [label for _, label in frames],
        "field": field,
    }
    return Viewer(_page(model.robot.name, shown), height)


def _frames(what: Any) -> tuple[Model, list[tuple[bytes, str]]]:
    """A packet and a line for people of each state."""
    from .program import ProgramResult

    if isinstance(what, ProgramResult):
        view = _pliant.View(what.model._model)
        return what.model, [(view.frame_of(s.positions, s.time), _label(s.observed)) for s in what]
    states = [what.rest()] if isinstance(what, Model) else [what] if isinstance(what, State) else what
    takes = "show takes a model, a state, a list of states or the result of a program"
    if not _check.is_several(states):
        raise TypeError(f"{takes}, not {type(what).__name__}")
    states = list(states)
    if not states:
        raise InputError("there are no states to show; give at least one")
    for state in states:
        if not isinstance(state, State):
            raise TypeError(f"{takes}; one of the states is {_check._shown(state)}")
    model: Model = states[0].model
    if any(s.model is not model for s in states):
        raise InputError("the states are not all of one model")
    view = _pliant.View(model._model)
    return model, [(view.frame(s._state), _label(s.observe())) for s in states]


def _label(seen: Observation) -> str:
    cables = [f"{name} {100 * c.length_ratio:.1f} %, {c.tension_N:.3g} N" for name, c in seen.cables.items()]
    chambers = [f"{name} {1e-3 * c.pressure_Pa:.3g} kPa" for name, c in seen.chambers.items()]
    return "; ".join(cables + chambers)


def _text(packet: bytes) -> str:
    return base64.b64encode(packet).decode("ascii")


def _page(name: str, shown: dict[str, Any]) -> str:
    script = (Path(__file__).parent / "viewer.js").read_text(encoding="utf-8").replace("</script", "<\\/script")
    data = json.dumps(shown).replace("</", "<\\/")
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{html.escape(name)}</title>'
        f'<style>{_STYLE}</style></head><body><div id="viewer"></div>'
        f'<script type="application/json" id="robot">{data}</script><script>{script}</script></body></html>'
    )
