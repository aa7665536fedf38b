"""Calls the module with wrong shapes, wrong types, numbers that are none, and objects that are gone.

    python3 fuzz.py [SECONDS [SEED [CALLS]]]

It ends after so many seconds or calls; the same seed makes the same calls. Everything that comes back must be an answer, or an error in a sentence: never a crash, and never an error of the
bindings ("incompatible function arguments"). Run under AddressSanitizer by python/test/fuzz_asan.
"""

from __future__ import annotations

import copy
import gc
import os
import pickle
import sys
import tempfile
import time
from typing import Any

import numpy as np
from robots import BLOCK, cube

import pliant
from pliant import _pliant


class Fuzz:
    """Random calls on few small robots."""

    def __init__(self, seed: int) -> None:
        self.random = np.random.default_rng(seed)
        self.folder = tempfile.TemporaryDirectory(prefix="pliant_fuzz")
        os.chdir(self.folder.name)  # where files with odd names do no harm
        self.calls = 0
        self.answers = 0
        self.kept: list[Any] = []
        self.fresh()

    def fresh(self) -> None:
        """New objects; what is kept of the old ones outlives them."""
        self.model = pliant.Model(pliant.Robot(BLOCK), cube())
        self.other = pliant.Model(pliant.Robot(BLOCK), cube())
        self.state = self.model.rest()
        self.batch = pliant.Batch(self.model, 2, threads=2)
        self.states = self.batch.rest()
        self.at = self.model.linearise(self.model.solve({"side": {"length_ratio": 0.98}}))
        gc.collect()

    def pick(self, *options: Any) -> Any:
        """One of them."""
        return options[int(self.random.integers(len(options)))]

    def number(self) -> Any:
        """A number, or what is none."""
        return self.pick(
            0, 1, -1, 2**31, 2**63, -(2**63), 10**30, 0.0, -0.0, 0.009, 0.0099, 1e308, -1e308, 5e-324, float("nan"),
            float("inf"), np.float32(0.009), np.int8(3), True, 1j, "0.009", "4 mm", None, [], b"\0", self.random.normal(),
        )  # fmt: skip

    def array(self) -> Any:
        """An array of any shape and kind."""
        shape = self.pick((), (0,), (1,), (2,), (3,), (8, 3), (3, 8), (8,), (24,), (1, 1), (6, 4), (2, 1), (0, 3), (7, 10))
        kind = self.pick(np.float64, np.float32, np.int32, np.int64, np.uint8, np.bool_, np.complex128, object, "U3")
        array = np.full(shape, self.pick(0, 1, 7, 8), dtype=kind)
        if array.size and array.dtype == np.float64 and self.random.random() < 0.5:
            array.flat[int(self.random.integers(array.size))] = self.pick(np.nan, np.inf, 1e300, -1)
        if array.dtype.kind == "i" and array.size and self.random.random() < 0.5:
            array.flat[int(self.random.integers(array.size))] = self.pick(-1, 8, 2**31 - 1)
        return self.pick(array, array[::-1] if array.ndim else array, np.asfortranarray(array), array.tolist(), memoryview(b"12"))

    def thing(self) -> Any:
        """Anything at all."""
        return self.pick(
            self.number(), self.array(), self.controls(), "side", "", "\0", "x" * 1000, {}, {"side": None}, (), object(),
            self.model, self.other, self.state, self.other.rest(), self.state.inputs, self.state.bytes(), pliant, type,
            lambda *a: False, lambda *a: 1 / 0, self.folder.name, self.at, self.batch, cube(), pliant.Measure("marker", "top"),
        )  # fmt: skip

    def controls(self) -> Any:
        """Something like controls."""
        kind = self.pick("length", "length_ratio", "shortening", "tension", "pressure", "volume", "gas", "", 3, None)
        return self.pick(
            {"side": {kind: self.number()}}, {"side": self.number()}, {"top": {kind: 1}}, {3: 4}, [self.number()],
            self.array(), self.state.inputs, None, {"side": pliant.Drive(kind, self.number())}, "side",
            pliant.Inputs(("side",), self.number(), [kind], [self.number()]), pliant.Inputs((), 0, [], []),
        )  # fmt: skip

    def robot(self) -> dict[str, Any]:
        """A robot with something wrong."""
        table: dict[str, Any] = copy.deepcopy(BLOCK)
        for _ in range(int(self.random.integers(1, 3))):
            at: Any = table
            while True:
                key = self.pick(*at) if isinstance(at, dict) else int(self.random.integers(len(at)))
                deeper = isinstance(at[key], (dict, list)) and len(at[key])
                if not deeper or self.random.random() < 0.4:
                    break
                at = at[key]
            at[key] = self.pick(self.number(), self.array(), {}, [], "", "memory:", [[0, 0, 0], [1, 1]], {"length_ratio": -1}, None)
        return table

    def one(self) -> None:
        """One call of anything."""
        calls = [
            lambda: self.model.step(self.state, self.controls(), time=self.pick(None, None, self.number())),
            lambda: self.model.step(self.thing(), self.controls()),
            lambda: self.model.step(self.state, self.controls(), progress=self.thing()),
            lambda: self.model.solve(self.controls(), state=self.thing(), time=self.number()),
            lambda: self.model.inputs(self.thing(), self.thing(), time=self.number()),
            lambda: self.model.program(self.number()),
            lambda: self.model.observe(self.thing()),
            lambda: self.model.fields(self.thing()),
            lambda: self.model.contact_forces(self.thing()),
            lambda: self.model.cable_paths(self.thing()),
            lambda: self.model.jacobian(self.thing(), self.thing()),
            lambda: self.model.grad(self.state, positions=self.array(), tensions=self.array(), markers=self.thing()),
            lambda: self.model.grad(self.state, markers={self.pick("top", "x", 3): self.array()}),
            lambda: self.model.state_from(self.broken()),
            lambda: self.model.load_state(self.saved()),
            lambda: self.state.save(self.thing()) if self.random.random() < 0.1 else None,
            lambda: self.batch.step(self.thing(), self.thing()),
            lambda: self.batch.step(self.states, [self.controls(), self.controls()], time=self.pick(None, self.number())),
            lambda: self.batch.step([self.thing(), self.states[0]], self.array(), progress=self.thing()),
            lambda: self.batch.observe(self.thing()),
            lambda: pliant.Batch(self.thing(), self.number(), threads=self.pick(0, 1, 2, -1, None, "2")),
            lambda: self.at.solve(self.array()),
            lambda: self.at.multiply(self.array()),
            lambda: self.at.change(self.array()),
            lambda: self.at.response(self.thing()),
            lambda: self.at.response_to_parameter(self.thing()),
            lambda: self.at.value(self.thing()),
            lambda: self.at.gradient_of(pliant.Measure(self.pick("marker", "tension", "reaction", ""), self.pick("top", "side", "bottom", "\0"), self.array())),
            lambda: pliant.Linearisation(self.thing()),
            lambda: pliant.Mesh(self.array(), self.array(), self.pick(None, self.array()), self.thing()),
            lambda: pliant.Model(pliant.Robot(BLOCK), pliant.Mesh(self.array(), self.array())),
            lambda: pliant.Model(pliant.Robot(BLOCK), pliant.Mesh(cube().points * self.pick(1, np.nan, 1e300, 0), self.random.integers(0, 9, (3, 4)))),
            lambda: pliant.Model(self.thing(), self.thing(), tolerance=self.number(), iteration_limit=self.number()),
            lambda: pliant.Model(pliant.Robot(self.robot()), cube()).rest().observe(),
            lambda: pliant.Robot(self.robot(), folder=self.thing(), changes=self.thing()),
            lambda: pliant.Robot.parse(self.text(), changes=self.thing()),
            lambda: pliant.Robot.load(self.thing(), self.thing()),
            lambda: self.model.run(on_step=self.thing(), measured=self.thing(), checkpoint_every=self.number(), progress=self.thing()),
            lambda: pliant.inverse(self.pick(self.model, self.thing()), starts=self.number()),
            lambda: pliant.workspace(self.pick(self.model, self.thing()), side=self.number(), between=self.number()),
            lambda: pliant.reduce(self.pick(self.model, self.thing()), samples=self.number(), basis_error=self.number()),
            lambda: pliant.ReducedModel.load(self.pick(self.model, self.thing()), self.thing()),
            lambda: pliant.identify(self.thing(), self.thing(), self.thing(), judge=self.thing()),
            lambda: pliant.gradient(self.model, [pliant.Measure("marker", "top", (0, 0, 1))], lambda step, values: self.thing(), kept=self.number()),
            lambda: pliant.plan(self.thing()),
            lambda: pliant.check(self.thing()),
            lambda: pliant.quantity(self.thing(), self.thing()),
            lambda: pliant.show(self.thing(), field=self.thing()),
            lambda: pickle.loads(pickle.dumps(self.pick(self.state, self.model, self.state.inputs))),
            lambda: self.raw(),
        ]  # fmt: skip
        answer = self.pick(*calls)()
        if self.random.random() < 0.2:
            self.kept.append(answer)
            self.kept.append(self.state.positions)
        if len(self.kept) > 50:
            self.use_kept()

    def raw(self) -> Any:
        """The extension itself, past everything that checks: it may complain in its own words, and must not crash."""
        part = self.pick(*[p for p in dir(_pliant) if not p.startswith("_")])
        thing = getattr(_pliant, part)
        arguments = [self.pick(self.thing(), self.model._model, self.state._state, self.model._engine, None) for _ in range(int(self.random.integers(0, 5)))]
        if part in ("slice", "print_virtually", "run", "workspace", "inverse", "identify", "program_gradient", "reduce"):
            arguments = arguments[:2]
        try:
            made = thing(*arguments)
            member = self.pick(*[m for m in dir(thing) if not m.startswith("_")] or ["__doc__"])
            return getattr(made, member)(*arguments[:2])
        except TypeError:
            return None

    def broken(self) -> Any:
        """Bytes of a state, most of them damaged."""
        data = bytearray(self.state.bytes())
        for _ in range(int(self.random.integers(0, 4))):
            data[int(self.random.integers(len(data)))] = int(self.random.integers(256))
        return self.pick(bytes(data), bytes(data[: int(self.random.integers(len(data)))]), b"", "text", data)

    def saved(self) -> str:
        """A file with such bytes."""
        file = os.path.join(self.folder.name, "state")
        with open(file, "wb") as out:
            data = self.broken()
            out.write(data.encode() if isinstance(data, str) else data)
        return file

    def text(self) -> Any:
        """A robot file, most of them damaged."""
        text = pliant.Robot(BLOCK).text
        cut = int(self.random.integers(len(text)))
        return self.pick(text[:cut], text[cut:], text.replace("0", self.pick("-1", "nan", "1e999", '"')), "\0", "", 3)

    def use_kept(self) -> None:
        """Objects whose owners are long gone."""
        for thing in self.kept:
            if isinstance(thing, np.ndarray):
                float(np.nansum(thing)) if thing.dtype.kind == "f" else thing.tolist()
            repr(thing)
        self.kept.clear()

    def run(self, seconds: float, most_calls: float) -> None:
        """Calls until the time is over, or that many."""
        end = time.monotonic() + seconds
        while time.monotonic() < end and self.calls < most_calls:
            self.calls += 1
            if self.calls % 200 == 0:
                self.fresh()
            try:
                self.one()
                self.answers += 1
            except (pliant.Failure, TypeError, IndexError, ZeroDivisionError, KeyError, MemoryError) as error:
                said = str(error)
                if "incompatible function arguments" in said or "Unable to cast" in said or not said:
                    raise AssertionError(f"call {self.calls} ends in no sentence: {said}") from error


def main() -> None:
    """As the command line says."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 10
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    most_calls = float(sys.argv[3]) if len(sys.argv) > 3 else float("inf")
    fuzz = Fuzz(seed)
    fuzz.run(seconds, most_calls)
    print(f"{fuzz.calls} calls, {fuzz.answers} answers, no crash (seed {seed})")


if __name__ == "__main__":
    main()
