"""Studies: runs a command for many sets of values, on all cores or on a cluster, with the results as arrays."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _check, _toml
from ._values import Value
from .errors import Cancelled, Failure, InputError, arguments_for_options, input_error


class SobolIndex(NamedTuple):
    """A Sobol index, the share of the variance of a result, with its 95 % confidence interval."""

    value: float
    low: float
    high: float


class KeySensitivity(NamedTuple):
    """Sobol indices of one key for one result."""

    #: first-order index: the key alone
    first: SobolIndex
    #: total index: the key alone and together with other keys
    total: SobolIndex


@dataclass(frozen=True, eq=False)
class StudyResult(Value):
    """Results of a study: arrays of the same length, one entry for each row."""

    #: values of each key by its name: numbers in `units`, or texts
    keys: dict[str, npt.NDArray[Any]]
    #: unit of each key by its name; "" if dimensionless
    units: dict[str, str]
    #: values of each result by its name; NaN where a row failed
    results: dict[str, npt.NDArray[np.float64]]
    #: True where the row succeeded
    done: npt.NDArray[np.bool_]
    #: why the row failed; "" where it succeeded
    reasons: npt.NDArray[np.str_]
    #: reasons not to trust the results of a row, as the command gave them; "" where it gave none
    warnings: npt.NDArray[np.str_]
    #: all figures, as in summary.json
    summary: dict[str, Any]
    #: folder of the study
    folder: Path

    def __len__(self) -> int:
        return len(self.done)

    @property
    def sensitivity(self) -> dict[str, dict[str, KeySensitivity]]:
        """Sobol indices by result and key; empty unless the plan is ``"sensitivity"``."""
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
        """Reads the folder of a study that was run from Python or on the command line."""
        path = _check.path(folder, "folder")
        for name in ("summary.json", "results.npz"):
            if not (path / name).is_file():
                raise InputError(f"{path}: is no folder of a study that has ended: it has no {name}", str(path))
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
                warnings=values["warning"],
                summary=summary,
                folder=path,
            )
        except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile) as error:
            raise InputError(f"{path}: is no folder of a study that has ended: {error}", str(path)) from None


def study(
    plan: Union[str, os.PathLike[str], Mapping[str, Any]],
    folder: Union[str, os.PathLike[str], None] = None,
    *,
    on: Literal["local", "slurm"] = "local",
    jobs: Optional[int] = None,
    resume: bool = False,
) -> StudyResult:
    """Runs a study as ``pliant study`` does, and returns its results as arrays.

    Rows that fail are kept: their results are NaN, and `reasons` says why.

    Args:
        plan: a study file; or its keys as a dict, which is written as ``FOLDER.toml`` beside `folder`. Files that the
            command names are looked up beside that file.
        folder: folder for rows and results; None: ``STUDY_study`` for a file ``STUDY.toml``.
        on: ``"local"``: all cores of this machine; ``"slurm"``: tasks of a cluster.
        jobs: number of rows at a time, or of tasks of the cluster; None: all cores, or all that the cluster gives.
        resume: continue with the rows that are in the folder.

    Raises:
        InputError: the plan or an option is invalid, or the folder or ``FOLDER.toml`` holds another study. A
            ``FOLDER.toml`` that is not the same study is never overwritten.
        Failure: the program `pliant` is not found, or Slurm does not accept the study.
    """
    _check.one_of(on, ("local", "slurm"), "on")
    options = ["--on", on, "--json", *_jobs_words(jobs), *(["--resume"] if resume else [])]
    out = None if folder is None else _check.path(folder, "folder")
    if isinstance(plan, Mapping):
        if out is None:
            raise InputError("a study that is described by a dict needs a folder for its results")
        file = _written(plan, out)
    else:
        file = _check.path(plan, "plan")
    out = out or Path(f"{file.stem}_study")
    status, output, errors = _run([str(_program()), "study", str(file), "--output", str(out), *options])
    told = _told(output)
    if status not in (0, 1) or told is None or "error" in told:
        _complain(status, told or {}, errors)
    return StudyResult.load(out)


#: Begins a file that study() wrote: it may be replaced as long as there are no results.
_MARK = "# Written by pliant.study from a dict.\n"


def _written(plan: Mapping[str, Any], out: Path) -> Path:
    """The file of a plan that is a dict, beside its folder of results."""
    file = out.absolute().with_name(out.name + ".toml")
    text = _MARK + _toml.document(plan)
    if file.exists() and not _may_replace(file, text, out):
        raise InputError(f"{file}: is there already, and is another study; choose another folder, or move it away")
    aside = file.with_name(file.name + ".partial")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        aside.write_text(text, encoding="utf-8")
        aside.replace(file)
    except OSError as error:
        raise InputError(f"{file}: cannot be written: {error.strerror}", file=str(file)) from None
    return file


def _may_replace(file: Path, text: str, out: Path) -> bool:
    try:
        there = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return False
    return there == text or there.startswith(_MARK) and not out.exists()


def _jobs_words(jobs: Any) -> list[str]:
    if jobs is None:
        return []
    count = _check.integer(jobs, "jobs")
    if not 1 <= count <= 100000:
        raise InputError(f"jobs is {count}; it must be from 1 to 100000, or None for all cores")
    return ["--jobs", str(count)]


def _told(output: str) -> dict[str, Any] | None:
    """What the program printed as JSON."""
    try:
        told = json.loads(output)
    except ValueError:
        return None
    return told if isinstance(told, dict) else None


#: Words of the command line in messages, and those of study().
_ARGUMENTS = {
    "--resume goes on with them, -o names": "resume=True goes on with them, folder names",
    "the same command with --resume continues": "the same study with resume=True continues",
    ", or --chunk N for a part of the study in the folder": "",
}


def _complain(status: int, told: dict[str, Any], errors: str) -> None:
    """Raises the error that the program reported, in its output or among its errors."""
    lines = errors.strip().splitlines()
    ended = f"pliant study ended with exit status {status}"
    message = str(told["error"]) if "error" in told else lines[-1] if lines else ended
    with arguments_for_options(_ARGUMENTS):
        if status == 2:
            raise input_error(message)
        raise (Cancelled if message.startswith("cancelled") else Failure)(message)


def _run(words: list[str]) -> tuple[int, str, str]:
    """An interrupt is passed on to the study once; it stops in good order before KeyboardInterrupt is raised here."""
    pipe, none = subprocess.PIPE, subprocess.DEVNULL
    try:
        process = subprocess.Popen(words, stdin=none, stdout=pipe, stderr=pipe, text=True, start_new_session=True)
    except OSError as error:
        raise Failure(f"{words[0]}: cannot be started: {error.strerror}", file=words[0]) from None
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
    if named:
        if not (Path(named).is_file() and os.access(named, os.X_OK)):
            raise Failure(f"PLIANT_PROGRAM names {named}, which is no program")
        return Path(named)
    for candidate in near:
        if candidate.is_file() and os.access(candidate, os.X_OK):
            return candidate
    found = shutil.which("pliant")
    if found is None:
        raise Failure(
            "studies are run by the program pliant, which is not beside this module and not in PATH; "
            "install it, or name it in PLIANT_PROGRAM"
        )
    return Path(found)
