"""Studies: any command over a plan of experiments, on all cores or on a cluster, with the results as arrays."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _toml
from .errors import Cancelled, Failure, InputError


class SobolIndex(NamedTuple):
    """A share of a result's variance, and the interval that holds it with a confidence of 95 %."""

    value: float
    low: float
    high: float


class KeySensitivity(NamedTuple):
    """What a key does to a result."""

    #: alone
    first: SobolIndex
    #: alone and together with other keys
    total: SobolIndex


@dataclass(frozen=True)
class StudyResult:
    """What a study found: arrays of the same length, a row each."""

    #: by the key's name: numbers in `units`, or texts
    keys: dict[str, npt.NDArray[Any]]
    #: by the key's name; "" for pure numbers
    units: dict[str, str]
    #: by the result's name; NaN where a row failed
    results: dict[str, npt.NDArray[np.float64]]
    #: whether the row ran through
    done: npt.NDArray[np.bool_]
    #: why it failed; "" where it did not
    reasons: npt.NDArray[np.str_]
    #: as summary.json has it
    summary: dict[str, Any]
    #: that holds all of it
    folder: Path

    def __len__(self) -> int:
        return len(self.done)

    @property
    def sensitivity(self) -> dict[str, dict[str, KeySensitivity]]:
        """By result and key; empty unless the plan is ``"sensitivity"``."""
        found: dict[str, dict[str, KeySensitivity]] = {}
        for name, figures in self.summary["results"].items():
            if "sensitivity" in figures:
                found[name] = {
                    key: KeySensitivity(SobolIndex(**both["first"]), SobolIndex(**both["total"]))
                    for key, both in figures["sensitivity"]["keys"].items()
                }
        return found

    @classmethod
    def load(cls, folder: Union[str, os.PathLike[str]]) -> StudyResult:
        """Of the folder of a study that was run, here or by the command line."""
        path = Path(folder)
        try:
            summary = json.loads((path / "summary.json").read_text(encoding="utf-8"))
            with np.load(path / "results.npz") as arrays:
                values = {name: arrays[name] for name in arrays.files}
            return cls(
                keys={k["name"]: values[f"key.{k['name']}"] for k in summary["keys"]},
                units={k["name"]: k["unit"] for k in summary["keys"]},
                results={name: values[f"result.{name}"] for name in summary["results"]},
                done=values["done"],
                reasons=values["reason"],
                summary=summary,
                folder=path,
            )
        except (OSError, ValueError, KeyError) as error:
            raise InputError(f"{path}: is no folder of a study that has ended: {error}", str(path)) from None


def study(
    plan: Union[str, os.PathLike[str], Mapping[str, Any]],
    folder: Union[str, os.PathLike[str], None] = None,
    *,
    on: Literal["local", "slurm"] = "local",
    jobs: Optional[int] = None,
    resume: bool = False,
) -> StudyResult:
    """Runs a study as ``pliant study`` does, and gives its results as arrays.

    Rows that fail are kept: their results are NaN, and `reasons` says why.

    Args:
        plan: a study file; or its keys as a dict, which is written as ``FOLDER.toml`` beside `folder`. Files that the
            command names are beside that file.
        folder: for rows and results; without it ``STUDY_study`` of a file ``STUDY.toml``.
        on: ``"local"``: all cores of this machine; ``"slurm"``: tasks of a cluster.
        jobs: rows at a time, or tasks of the cluster; None: all cores, or all that the cluster gives.
        resume: go on with the rows that are in the folder.

    Raises:
        InputError: the plan is wrong, or the folder holds another study.
        Failure: the program `pliant` is not there; Slurm does not take the study.
    """
    if isinstance(plan, Mapping):
        if folder is None:
            raise InputError("a study that is described by a dict needs a folder for its results")
        file = Path(folder).with_name(Path(folder).name + ".toml")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(_toml.document(plan), encoding="utf-8")
    else:
        file = Path(plan)
    if on not in ("local", "slurm"):
        raise InputError(f'on is {on!r}; it is "local" or "slurm"')
    out = Path(folder) if folder is not None else Path(f"{file.stem}_study")
    words = [str(_program()), "study", str(file), "--output", str(out), "--on", on, "--json"]
    if jobs is not None:
        words += ["--jobs", str(int(jobs))]
    if resume:
        words.append("--resume")
    status, output, errors = _run(words)
    if status not in (0, 1) or not output.lstrip().startswith("{") or "error" in json.loads(output):
        _complain(status, output, errors)
    return StudyResult.load(out)


def _complain(status: int, output: str, errors: str) -> None:
    lines = errors.strip().splitlines()
    message = lines[-1] if lines else f"pliant study ended with exit status {status}"
    if status == 2:
        raise InputError(message)
    raise (Cancelled if message.startswith("cancelled") else Failure)(message)


def _run(words: list[str]) -> tuple[int, str, str]:
    """An interrupt reaches the study once, and it stops in good order before the interrupt goes on."""
    process = subprocess.Popen(
        words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    try:
        output, errors = process.communicate()
    except BaseException:
        process.send_signal(signal.SIGINT)
        process.communicate()
        raise
    return process.returncode, output, errors


def _program() -> Path:
    """What PLIANT_PROGRAM names, else what this module was built or installed with, else what PATH has."""
    here = Path(__file__).resolve().parent
    named = os.environ.get("PLIANT_PROGRAM")
    near = [here.parents[1] / "apps" / "pliant" / "pliant"] + [up / "bin" / "pliant" for up in here.parents[:5]]
    for candidate in ([Path(named)] if named else []) + near:
        if candidate.is_file() and os.access(candidate, os.X_OK):
            return candidate
    found = shutil.which("pliant")
    if found is None:
        raise Failure(
            "studies are run by the program pliant, which is not beside this module and not in PATH; "
            "install it, or name it in PLIANT_PROGRAM"
        )
    return Path(found)
