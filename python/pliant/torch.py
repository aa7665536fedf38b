"""Equilibria as functions of torch: values by :meth:`Model.solve`, first derivatives by :meth:`Model.grad`.

Second derivatives (a gradient of a gradient, with ``create_graph=True``) are an error of torch.

Needs torch; the rest of the module does not.
"""

from __future__ import annotations

from typing import Any

import numpy as np

try:
    import torch
    from torch.autograd.function import once_differentiable
except ImportError as error:
    raise ImportError("pliant.torch needs PyTorch (Debian: python3-torch)") from error

from . import _check
from .model import Model, State


class _Positions(torch.autograd.Function):  # type: ignore[misc]
    @staticmethod
    def forward(ctx: Any, controls: Any, model: Model, start: State | None) -> Any:
        ctx.state = model.solve(controls.detach().cpu().numpy().astype(np.float64), state=start)
        return torch.from_numpy(ctx.state.positions.copy()).to(controls)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *grads: Any) -> Any:
        found = ctx.state.model.grad(ctx.state, positions=grads[0].detach().cpu().numpy().astype(np.float64))
        return torch.from_numpy(found.controls).to(grads[0]), None, None


class _Markers(torch.autograd.Function):  # type: ignore[misc]
    @staticmethod
    def forward(ctx: Any, controls: Any, model: Model, start: State | None) -> Any:
        ctx.state = model.solve(controls.detach().cpu().numpy().astype(np.float64), state=start)
        return torch.from_numpy(ctx.state.markers()).to(controls)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *grads: Any) -> Any:
        model = ctx.state.model
        rows = grads[0].detach().cpu().numpy().astype(np.float64)
        found = model.grad(ctx.state, markers=dict(zip(model.markers, rows)))
        return torch.from_numpy(found.controls).to(grads[0]), None, None


def positions(model: Model, controls: Any, state: State | None = None) -> Any:
    """(nodes, 3) node positions at these controls, m, with a gradient.

    Args:
        model: the model that is solved.
        controls: tensor (cables + chambers,) in SI units, of the kinds of `state`.
        state: the state to start from; None: the rest state. There is no gradient with respect to it.
    """
    return _Positions.apply(*_given(model, controls, state))


def markers(model: Model, controls: Any, state: State | None = None) -> Any:
    """(markers, 3) marker positions at these controls, m, with a gradient; otherwise as :func:`positions`."""
    return _Markers.apply(*_given(model, controls, state))


def _given(model: Model, controls: Any, state: State | None) -> tuple[Any, Model, State | None]:
    if not isinstance(controls, torch.Tensor):
        raise TypeError(f"controls must be a tensor, not {type(controls).__name__}")
    return controls, _check.instance(model, Model, "model"), state
