"""Printing in several resins: from bodies to a job file, its plan, its proof, and a print on the virtual printer."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, Union

import numpy as np
import numpy.typing as npt

from . import _check, _pliant
from ._check import Array, PathLike, Progress
from .robot import Changes, _changes


class Vat(NamedTuple):
    """A vat that a job uses."""

    #: where it stands, from 1
    slot: int
    #: what it must hold
    resin: str
    #: that the job uses
    resin_ml: float
    #: the printer file names another resin for it, or none
    refill: bool


@dataclass(frozen=True)
class PrintPlan:
    """What a job takes on its printer."""

    #: of the part
    layers: int
    #: changes of vat
    swaps: int
    #: in all
    seconds: float
    #: of them, for changes of vat
    swap_s: float
    #: for cleaning
    clean_s: float
    #: for light
    expose_s: float
    #: for all other motion
    move_s: float
    #: cleaning solution used up
    solution_ml: float
    #: in the order of the printer file
    vats: list[Vat]
    #: a sentence each
    warnings: list[str]


@dataclass(frozen=True)
class CuredBlock:
    """What has cured, voxel by voxel: pixels of the projector across, cured layers up."""

    #: (layers, y, x) 0: nothing, k: the k-th of `resins`. Cannot be written.
    resin: npt.NDArray[np.uint8]
    #: (layers, y, x) of the voxel that is solid, 255: all of it. Cannot be written.
    share: npt.NDArray[np.uint8]
    #: that have cured; index + 1 in `resin`
    resins: list[str]
    #: (3,) the lowest x, y and z of the block on the platform, mm
    corner_mm: Array
    #: length of a voxel along x and y
    pixel_mm: float
    #: (layers,) where a layer begins, mm
    bottoms_mm: Array
    #: (layers,) where it ends, mm
    tops_mm: Array

    def volumes_mm3(self) -> dict[str, float]:
        """By resin."""
        heights = (self.tops_mm - self.bottoms_mm) * self.pixel_mm**2 / 255
        return {
            name: float(sum(h * s[r == k].sum(dtype=np.int64) for h, s, r in zip(heights, self.share, self.resin)))
            for k, name in enumerate(self.resins, 1)
        }


@dataclass(frozen=True)
class VirtualPrint:
    """What a print on the virtual printer came to."""

    #: the part is as the job asks, and nothing happened that must not
    passed: bool
    #: why it did not pass, a sentence each
    reasons: list[str]
    #: of the machine's clock
    seconds: float
    #: that cured
    layers: int
    #: by material: volume that cured in its own resin
    cured_mm3: dict[str, float]
    #: of the print, as the host writes it
    journal: str
    #: what has cured, where it was asked for
    block: CuredBlock | None


def slice(
    inputs: Union[PathLike, Iterable[PathLike]],
    job: PathLike,
    *,
    printer: PathLike,
    changes: Changes = None,
    resins: Mapping[str, str] | None = None,
    layer: str = "",
    copies: int = 1,
    any_vat: bool = False,
    support: str = "",
    progress: Progress | None = None,
) -> PrintPlan:
    """Slices, plans and writes the job file, whole or not at all: what ``pliant slice`` does.

    Args:
        inputs: a robot file; or any of FILE.3mf, FILE.vtk (regions are materials) and MATERIAL=FILE of a surface.
        job: the file that is written (.zip).
        printer: printer file (TOML).
        changes: of the robot file, {"parameters.notches": 5}.
        resins: by material, what it is printed in.
        layer: height of a layer with its unit, as "50 um"; "": the printer's.
        copies: side by side.
        any_vat: a resin that no vat holds is filled into a free one.
        support: material of supports; "": none.
        progress: called with (stage, share) some times a second; False cancels.
    """
    files = [inputs] if isinstance(inputs, str) or hasattr(inputs, "__fspath__") else list(inputs)
    plan = _pliant.slice(
        [str(_check.path(file, "inputs")) for file in files],
        _check.path(printer, "printer"),
        _check.path(job, "job"),
        _changes(changes),
        [f"{material}={resin}" for material, resin in (resins or {}).items()],
        str(layer),
        _check.integer(copies, "copies"),
        bool(any_vat),
        str(support),
        _check.progress(progress),
    )
    return _plan(plan)


def plan(job: PathLike) -> PrintPlan:
    """Plans a job again, for its own printer."""
    return _plan(_pliant.plan(_check.path(job, "job")))


def check(job: PathLike) -> list[str]:
    """Proves a job as everything that prints does: every image against its fingerprint, the G-code against the machine.

    Returns:
        Warnings, of what could not be proved.

    Raises:
        Failure: names file, entry or line, and layer.
    """
    return _pliant.check(_check.path(job, "job"))


def print_virtually(job: PathLike, *, block: bool = False, progress: Progress | None = None) -> VirtualPrint:
    """Prints a job on the virtual printer, by the engine that prints on machines; takes seconds.

    Args:
        job: the file that :func:`slice` wrote.
        block: also gives what has cured as arrays: two bytes for each voxel.
        progress: called with (stage, share) some times a second; False cancels.
    """
    found = _pliant.print_virtually(_check.path(job, "job"), bool(block), _check.progress(progress))
    found["cured_mm3"] = dict(found["cured_mm3"])
    found["block"] = None if found["block"] is None else CuredBlock(*found["block"])
    return VirtualPrint(**found)


def _plan(plan: dict[str, Any]) -> PrintPlan:
    plan["vats"] = [Vat(*v) for v in plan["vats"]]
    return PrintPlan(**plan)
