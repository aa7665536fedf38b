"""Box spaces: those of Gymnasium if it is installed, otherwise one with the same interface."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from .. import _check


class Space(Protocol):
    """The part of the interface of Gymnasium's spaces that environments use."""

    low: npt.NDArray[Any]
    high: npt.NDArray[Any]
    shape: tuple[int, ...]
    dtype: Any

    def sample(self) -> npt.NDArray[Any]: ...
    def contains(self, x: Any) -> bool: ...
    def seed(self, seed: int | None = None) -> Any: ...


class OwnBox:
    """All arrays of one shape between two bounds, as `gymnasium.spaces.Box`."""

    def __init__(self, low: Any, high: Any, shape: tuple[int, ...] | None = None, dtype: Any = np.float32) -> None:
        self.shape = tuple(np.shape(low)) if shape is None else tuple(shape)
        self.dtype = np.dtype(dtype)
        self.low = np.broadcast_to(np.asarray(low, self.dtype), self.shape).copy()
        self.high = np.broadcast_to(np.asarray(high, self.dtype), self.shape).copy()
        self._random = np.random.default_rng()

    def seed(self, seed: int | None = None) -> list[int | None]:
        """Seeds :meth:`sample`."""
        self._random = np.random.default_rng(None if seed is None else _check.seed(seed))
        return [seed]

    def sample(self) -> npt.NDArray[Any]:
        """A random array: uniform between finite bounds, otherwise normally distributed."""
        bounded = np.isfinite(self.low) & np.isfinite(self.high)
        low, high = np.where(bounded, self.low, 0), np.where(bounded, self.high, 1)
        flat = np.where(bounded, self._random.uniform(low, high), self._random.normal(size=self.shape))
        return flat.astype(self.dtype)

    def contains(self, x: Any) -> bool:
        """True if x has the shape and is within the bounds."""
        try:
            array = np.asarray(x)
        except ValueError:  # rows of different lengths
            return False
        if array.shape != self.shape or not np.can_cast(array.dtype, self.dtype):
            return False
        return bool(np.all(array >= self.low) and np.all(array <= self.high))

    def __contains__(self, x: Any) -> bool:
        return self.contains(x)

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, OwnBox)
            and self.shape == other.shape
            and np.array_equal(self.low, other.low)
            and np.array_equal(self.high, other.high)
        )

    def __repr__(self) -> str:
        return f"Box({self.low.min(initial=0)}, {self.high.max(initial=0)}, {self.shape}, {self.dtype})"


def box(low: Any, high: Any, shape: tuple[int, ...] | None = None, dtype: Any = np.float32) -> Any:
    """A Box of Gymnasium if it is installed, otherwise an OwnBox."""
    try:
        from gymnasium.spaces import Box
    except ImportError:
        return OwnBox(low, high, shape, dtype)
    return Box(low, high, shape, dtype)
