"""Reduced-order models: as the whole robot, an estimate of the difference, and files."""

import numpy as np
import pytest
from robots import BAR

import pliant

CABLE = {**BAR["cable"][0], "range": ["0 mm", "8 mm"]}


@pytest.fixture(scope="module")
def model():
    return pliant.Model(pliant.Robot({**BAR, "cable": [CABLE]}))


@pytest.fixture(scope="module")
def reduced(model):
    return pliant.reduce(model, samples=16)


def test_a_reduced_model_moves_as_the_robot(model, reduced):
    assert 0 < reduced.mode_count < 16 and 0 < reduced.tet_count < model.tet_count
    assert reduced.sample_count == 16 and not reduced.notes and reduced.inputs[0].name == "flexor"
    state = reduced.start()
    kept = state.copy()
    for pull in ("1 mm", "3.3 mm", "7.1 mm"):
        step = reduced.step(state, {"flexor": {"shortening": pull}})
        assert step.found and step.iterations > 0
        whole = model.solve({"flexor": {"shortening": pull}})
        assert state.markers == pytest.approx(whole.markers(), abs=2e-5)
        assert state.tensions[0] == pytest.approx(whole.observe().cables["flexor"].tension_N, rel=5e-3)
        assert state.pressures.shape == (0,) and state.positions.shape == (model.node_count, 3)
        error = reduced.estimate(state)
        assert 0 <= error.markers["tip"] <= error.error < 1e-4
        exact = reduced.exact(state)
        assert exact.positions == pytest.approx(whole.positions, abs=1e-6)
    assert not np.array_equal(kept.amplitudes, state.amplitudes)
    assert reduced.step(state, np.array([kept.inputs["flexor"].value])).found
    assert reduced.solve({"flexor": {"tension": "0.5 N"}}).tensions[0] == pytest.approx(0.5)


def test_a_reduced_model_is_checked_and_stored(model, reduced, tmp_path):
    checks = reduced.check(3)
    assert len(checks) == 3 and all(c.found and c.error < 0.01 * c.motion for c in checks)
    file = tmp_path / "bar.reduced"
    reduced.save(file)
    again = pliant.ReducedModel.load(model, file)
    pull = {"flexor": {"shortening": "5 mm"}}
    assert np.array_equal(again.solve(pull).amplitudes, reduced.solve(pull).amplitudes)
    other = pliant.Model(pliant.Robot({**BAR, "cable": [{**CABLE, "range": ["0 mm", "7 mm"]}]}))
    with pytest.raises(pliant.InputError, match="made for another robot"):
        pliant.ReducedModel.load(other, file)
    file.write_bytes(file.read_bytes()[:1000])
    with pytest.raises(pliant.InputError, match="bar.reduced: not a reduced model, or damaged"):
        pliant.ReducedModel.load(model, file)


def test_mistakes_with_reduced_models(model, reduced):
    with pytest.raises(pliant.InputError, match="range"):
        pliant.reduce(pliant.Model(pliant.Robot(BAR)))
    with pytest.raises(pliant.InputError, match="friction of cables"):
        pliant.reduce(pliant.Model(pliant.Robot({**BAR, "cable": [{**CABLE, "friction": 0.1}]})))
    with pytest.raises(pliant.InputError, match="samples"):
        pliant.reduce(model, samples=-1)
    with pytest.raises(pliant.InputError, match="between 0 and 1"):
        pliant.reduce(model, basis_error=0.0)
    with pytest.raises(pliant.Cancelled):
        pliant.reduce(model, progress=lambda stage, share: False)
    with pytest.raises(pliant.InputError, match="another reduced model"):
        reduced.step(pliant.reduce(model, samples=4).start(), None)
    with pytest.raises(TypeError):
        reduced.step(model.rest(), None)
    with pytest.raises(pliant.InputError, match="there is no cable or chamber 'extensor'"):
        reduced.step(reduced.start(), {"extensor": {"shortening": "1 mm"}})


def test_a_progress_callable_cannot_use_the_reduced_model_at_work(reduced):
    state = reduced.start()
    with pytest.raises(pliant.InputError, match="the reduced model is at work: its progress cannot use it"):
        reduced.exact(state, progress=lambda *_: reduced.estimate(state))
