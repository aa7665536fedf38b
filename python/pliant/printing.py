"""Multi-resin printing: from bodies to a job file, its plan, its check, and a print on the virtual printer."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, Union

import numpy as np
import numpy.typing as npt

from . import _check, _pliant
from ._check import Array, PathLike, Progress
from ._values import Value
from .errors import InputError, arguments_for_options
from .robot import Changes, Robot, _changes


_ARGUMENTS = {
    "--resin MATERIAL=RESIN": "resins={MATERIAL: RESIN}",
    "--resin": "resins",
    "--any-vat": "any_vat=True",
    "--layer": "layer",
    "--copies": "copies",
    "--support": "support",
    "--printer": "printer",
    "--set ": "changes: ",
    "a mesh in memory can only be given by a program; name a file": "a mesh in memory cannot be sliced; name a file",
}


class Vat(NamedTuple):
    """A vat used by a job."""

    #: its place in the tower, from 1
    slot: int
    #: the resin it must hold
    resin: str
    #: resin used by the job, ml
    resin_ml: float
    #: True if it is to be filled in before the print: the printer file names another resin for it, or none
    refill: bool
    #: layers, from 0, before which it must be refilled during the print
    refills: list[int]


@dataclass(frozen=True)
class PrintPlan:
    """What a job needs on its printer."""

    #: number of layers of the part
    layers: int
    #: number of vat swaps
    swaps: int
    #: total printing time, s
    seconds: float
    #: part of it for vat swaps, s
    swap_s: float
    #: part of it for cleaning, s
    clean_s: float
    #: part of it for exposure, s
    expose_s: float
    #: part of it for all other motion, s
    move_s: float
    #: cleaning solution used, ml
    solution_ml: float
    #: in the order of the printer file
    vats: list[Vat]
    #: one sentence each
    warnings: list[str]


@dataclass(frozen=True, eq=False)
class CuredBlock(Value):
    """The cured part as voxels: one projector pixel wide, one cured layer high."""

    #: (layers, y, x) 0: nothing cured, k: cured in the k-th of `resins`. Cannot be written.
    resin: npt.NDArray[np.uint8]
    #: (layers, y, x) share of the voxel that is solid, 255: all of it. Cannot be written.
    share: npt.NDArray[np.uint8]
    #: names of the resins that have cured; index + 1 in `resin`
    resins: list[str]
    #: (3,) lowest x, y and z of the block on the platform, mm
    corner_mm: Array
    #: length of a voxel along x and y, mm
    pixel_mm: float
    #: (layers,) lower end of each layer, mm
    bottoms_mm: Array
    #: (layers,) upper end of each layer, mm
    tops_mm: Array

    def volumes_mm3(self) -> dict[str, float]:
        """Cured volume of each resin by its name, mm^3."""
        heights = (self.tops_mm - self.bottoms_mm) * self.pixel_mm**2 / 255
        return {
            name: float(sum(h * s[r == k].sum(dtype=np.int64) for h, s, r in zip(heights, self.share, self.resin)))
            for k, name in enumerate(self.resins, 1)
        }


@dataclass(frozen=True)
class VirtualPrint:
    """Result of a print on the virtual printer."""

    #: True if the part matches the job and no fault occurred
    passed: bool
    #: why it did not pass, one sentence each
    reasons: list[str]
    #: printing time on the clock of the machine, s
    seconds: float
    #: number of cured layers
    layers: int
    #: volume that cured in the resin of each material, by material, mm^3
    cured_mm3: dict[str, float]
    #: journal of the print, as the host writes it
    journal: str
    #: the cured part, if requested
    block: CuredBlock | None


def slice(
    inputs: Union[Robot, PathLike, Iterable[PathLike]],
    job: PathLike,
    *,
    printer: PathLike,
    changes: Changes = None,
    resins: Mapping[str, str] | None = None,
    layer: str | None = None,
    copies: int = 1,
    any_vat: bool = False,
    support: str | None = None,
    progress: Progress | None = None,
) -> PrintPlan:
    """Slices, plans and writes the job file, whole or not at all: what ``pliant slice`` does.

    Args:
        inputs: a robot file or a :class:`Robot`; or any of FILE.3mf, FILE.vtk (regions are materials) and MATERIAL=FILE
            of a surface.
        job: path of the job file that is written (.zip).
        printer: printer file (TOML), or the name of a built-in printer: "tower". ``pliant new`` lists them.
        changes: changes of the robot file, as {"parameters.notches": 5}.
        resins: the resin of each material, by material.
        layer: height of a layer with its unit, as "50 um"; None: that of the printer.
        copies: number of copies, placed side by side.
        any_vat: fill a resin that no vat holds into a free vat.
        support: material of supports; None: no supports.
        progress: called with (stage, share) some times a second; False cancels.
    """
    with arguments_for_options(_ARGUMENTS), _files_of(inputs) as files:
        plan = _pliant.slice(
            files,
            _check.path_text(printer, "printer"),
            _check.path_text(job, "job"),
            _changes(changes),
            _resin_words(resins),
            _word(layer, "layer"),
            _check.integer(copies, "copies"),
            bool(any_vat),
            _word(support, "support"),
            _check.progress(progress),
        )
    return _plan(plan)


def _word(value: Any, what: str) -> str:
    """A text that is not empty; "" for None."""
    if value == "":
        raise InputError(f"{what} is an empty text; leave it out, or write what it is")
    return "" if value is None else _check.text(value, what)


def _resin_words(resins: Any) -> list[str]:
    if resins is not None and not isinstance(resins, Mapping):
        raise InputError('resins must be a dict, as {"soft": "elastic 50A"}')
    return [
        f'{_check.text(material, "each material of resins")}={_check.text(resin, f"the resin of {material}")}'
        for material, resin in (resins or {}).items()
    ]


@contextmanager
def _files_of(inputs: Any) -> Iterator[list[bytes]]:
    """The files to be sliced, whose names need not be UTF-8; a robot is written to one that lasts as long as the work."""
    if not isinstance(inputs, Robot):
        several = isinstance(inputs, Iterable) and not isinstance(inputs, (str, bytes))
        yield [os.fsencode(_check.path(file, "inputs")) for file in (inputs if several else [inputs])]
        return
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "robot.toml"
        file.write_text(inputs._robot.text(folder), encoding="utf-8")
        with inputs._in_its_words(file):
            yield [os.fsencode(file)]


def plan(job: PathLike) -> PrintPlan:
    """Recomputes the plan of a job for the printer stored in it."""
    return _plan(_pliant.plan(_check.path_text(job, "job")))


def check(job: PathLike, *, progress: Progress | None = None) -> list[str]:
    """Verifies a job as is done before every print: each image against its checksum, the G-code against the machine.

    Args:
        job: the file that :func:`slice` wrote.
        progress: called with (stage, share) some times a second; False cancels.

    Returns:
        Warnings about what could not be verified.

    Raises:
        Failure: with the file, the entry or line, and the layer.
    """
    return _pliant.check(_check.path_text(job, "job"), _check.progress(progress))


def print_virtually(job: PathLike, *, block: bool = False, progress: Progress | None = None) -> VirtualPrint:
    """Prints a job on the virtual printer, with the same code that prints on machines; takes seconds.

    Args:
        job: the file that :func:`slice` wrote.
        block: also return the cured part as arrays: two bytes for each voxel.
        progress: called with (stage, share) some times a second; False cancels.
    """
    found = _pliant.print_virtually(_check.path_text(job, "job"), bool(block), _check.progress(progress))
    found["cured_mm3"] = dict(found["cured_mm3"])
    found["block"] = None if found["block"] is None else CuredBlock(*found["block"])
    return VirtualPrint(**found)


def _plan(plan: dict[str, Any]) -> PrintPlan:
    plan["vats"] = [Vat(*v) for v in plan["vats"]]
    return PrintPlan(**plan)
