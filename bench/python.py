#!/usr/bin/python3
"""Prints the figures of docs/reference/python.md: import, calls, batches, environments.

    PYTHONPATH=build/release/python bench/python.py [BUILD]

On a computer that has nothing else to do. A call beside C++ needs a build with -DPLIANT_BENCH=ON.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "python" / "test"))

import numpy as np  # noqa: E402
from robots import block  # noqa: E402

import pliant  # noqa: E402
from pliant.envs import Crawl, Grasp, RobotEnv  # noqa: E402


def import_time() -> None:
    """Time to import the module, and then to use its first name, in a process that does nothing else."""
    code = (
        "import time; t = time.perf_counter(); import pliant; u = time.perf_counter(); pliant.Model; "
        "print(u - t, time.perf_counter() - t)"
    )
    runs = [
        subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.split()
        for _ in range(15)
    ]
    times_ms = 1e3 * np.array(runs, dtype=float)
    for what, times in zip(("import pliant", "until its first model can be made, with numpy"), times_ms.T):
        print(f"{what}: {times.min():.0f} ms minimum, {np.median(times):.0f} ms median")


def call_time(build: Path) -> None:
    """Time of a step of six tetrahedra, called from Python and from C++."""
    model = block()
    state = model.rest()
    lengths = [np.array([0.0095]), np.array([0.0096])]
    rounds = []
    for _ in range(15):
        begin = time.perf_counter()
        for k in range(400):
            model.step(state, lengths[k % 2])
        rounds.append((time.perf_counter() - begin) / 400)
    ours = 1e6 * min(rounds)
    program = build / "bench" / "pliant_python_calls"
    if not program.exists():
        print(f"a step of 6 tets: {ours:.1f} us in Python; not compared with C++: {program} is not built")
        return
    theirs = min(float(subprocess.run([program], check=True, capture_output=True, text=True).stdout) for _ in range(3))
    print(f"a step of 6 tets: {ours:.1f} us in Python, {theirs:.1f} us in C++: the call costs {ours - theirs:.1f} us")
    begin = time.perf_counter()
    for _ in range(20000):
        state.positions
    print(f"positions of a state as an array: {(time.perf_counter() - begin) / 20000 * 1e6:.2f} us")


def bar(size_mm: float, length_mm: float = 100) -> pliant.Model:
    """A bar of linear tets with a cable along its upper side."""
    return pliant.Model(
        pliant.Robot(
            name="bar",
            length_unit="mm",
            material={"soft": {"youngs_modulus": "1 MPa", "poisson_ratio": 0.45}},
            mesh={"order": 1, "size": f"{size_mm} mm"},
            body=[{"name": "bar", "material": "soft", "geometry": {"box": [[0, 0, 0], [length_mm, 12, 12]]}}],
            fixed=[{"name": "clamp", "box": [[0, 0, 0], [0, 12, 12]]}],
            cable=[
                {
                    "name": "flexor",
                    "points": [[x, 6, 10.5] for x in np.linspace(0, length_mm, 6)],
                    "target": {"shortening": "4 mm"},
                }
            ],
        )
    )


class Rate(NamedTuple):
    """Speed of a batch."""

    #: robot-steps per second
    wall: float
    #: processor time of all threads per robot-step, s
    processor_s: float


def rate_of(model: pliant.Model, robots: int, threads: int, steps: int) -> tuple[Rate, list[pliant.State]]:
    """Robots whose cables shorten by 1 % of their length in each step, and lengthen again."""
    batch = pliant.Batch(model, robots, threads=threads)
    states = batch.rest()
    rest = states[0].inputs.values_SI[0]
    spread = 1 - 0.002 * np.arange(robots)[:, None] / robots
    batch.step(states, rest * spread)
    begin, processor = time.perf_counter(), time.process_time()
    for k in range(steps):
        share = 1 - 0.01 * (1 + (k if k < steps // 2 else steps - k))
        results = batch.step(states, rest * share * spread)
        assert all(r.arrived for r in results)
    done = robots * steps
    return Rate(done / (time.perf_counter() - begin), (time.process_time() - processor) / done), states


def batch_times() -> None:
    """64 robots of 1,000 tets on one core and on all, and fewer of 7,400."""
    model = bar(4.5)
    cores = len(os.sched_getaffinity(0))
    rates, ends = {}, []
    for threads in sorted({1, 2, cores}):
        found = [rate_of(model, 64, threads, 8) for _ in range(3)]
        rates[threads] = Rate(max(r.wall for r, _ in found), min(r.processor_s for r, _ in found))
        ends.append(found[-1][1])
    assert all(end == ends[0] for end in ends), "the bits depend on the number of threads"
    print(f"64 robots of {model.tet_count} tets, each step shortens the cable by 1 %:")
    for threads, rate in rates.items():
        print(
            f"  {threads} threads: {rate.wall:.0f} robot-steps per second, "
            f"{rate.wall / rates[1].wall:.2f} times one thread; "
            f"{1e3 * rate.processor_s:.2f} ms of processor time per robot-step"
        )
    large = bar(2.19)
    rate, _ = rate_of(large, 2 * cores, 0, 4)
    # Published for SOFA's inverse: 50 ms for a time step of one robot with 7,400 tets, in one process.
    print(
        f"{2 * cores} robots of {large.tet_count} tets: {rate.wall:.1f} robot-steps per second, "
        f"{rate.wall / 20:.1f} times the published 20; {1e3 * rate.processor_s:.1f} ms of processor time per robot-step, "
        f"the published 50 ms over that is {0.05 / rate.processor_s:.1f}"
    )


#: published time of SOFA for a step of 7,400 tets, s
PUBLISHED_STEP_S = 0.05


def environment_rate(env: RobotEnv, steps: int) -> tuple[float, float, float]:
    """Steps of 20 ms per second of wall time and of processor time, and how far the middle or the cube has moved (m)."""
    env.reset(seed=1)
    begin, processor = time.perf_counter(), time.process_time()
    for k in range(steps):
        if isinstance(env, Crawl):  # an arch that runs from the tail to the head
            phase = k % 30
            action = [1 if phase < 10 else -1, -1 if phase < 10 or phase >= 20 else 1]
        else:
            action = [1, 1]
        *_, terminated, _, info = env.step(action)
        assert not terminated, info
    return steps / (time.perf_counter() - begin), steps / (time.process_time() - processor), info.get("way_m", info.get("away_m"))


def environment_times() -> None:
    """The environments' crawler and gripper with a cube, and a crawler of about 7,400 tets."""
    fine = Crawl.make_model(size_mm=2.35)
    for name, env, steps in (("Crawl", Crawl(), 90), ("Grasp", Grasp(), 55), ("Crawl, fine", Crawl(fine), 60)):
        wall, processor, way = environment_rate(env, steps)
        print(
            f"{name}: {env.model.tet_count} tets, steps of 20 ms: {wall:.1f} per second, "
            f"{processor:.1f} per second of processor time, {PUBLISHED_STEP_S * processor:.2f} times the published speed; moved by {1e3 * way:.1f} mm"
        )


if __name__ == "__main__":
    import_time()
    call_time(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE.parent / "build" / "release")
    batch_times()
    environment_times()
