"""What mypy --strict must pass, and what it must refuse (test_typing.py)."""

from pathlib import Path

import numpy as np

import pliant


def heights(file: Path) -> list[float]:
    model = pliant.Model(pliant.Robot.load(file, {"mesh.order": 1}))
    state = model.rest()
    found: list[float] = []
    for shortening in ("1 mm", "2 mm"):
        result = model.step(state, {"flexor": {"shortening": shortening}})
        if result.arrived:
            found.append(float(state.observe().markers["tip"][2]))
    model.step(state, np.array([0.05]), progress=lambda stage, share: share < 1)
    jacobian = model.jacobian(state)
    gradient = model.grad(state, markers={"tip": [0, 0, 1]})
    found.append(float(jacobian[0, 2, 0] - gradient.controls[0]))
    batch = pliant.Batch(model, 4)
    states = batch.rest()
    found += [r.residual for r in batch.step(states, [[0.05]] * 4)]
    try:
        model.run().write(file.with_suffix(""), pictures="none")
    except pliant.InputError as error:
        raise SystemExit(f"{error.file}:{error.line}: {error.key}") from error
    plan: pliant.PrintPlan = pliant.slice(file, "job.zip", printer="tower.toml")
    found.append(plan.seconds)
    mesh = pliant.Mesh([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]], [0], ["all"])
    found.append(model.linearise(state).value(pliant.Measure("marker", "tip", [0, 0, 1])) + len(mesh.tets))
    observation, info = pliant.envs.Reach().reset(seed=2**40)
    found.append(float(observation[0]) + len(info))
    pliant.plotting.plot(state)
    waypoint = pliant.inverse(model)[0]
    found.append(waypoint.inputs["flexor"])
    return found
