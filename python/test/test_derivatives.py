"""Jacobians and gradients against differences, and what they are for."""

import numpy as np
import pytest
from robots import bar

import pliant


@pytest.fixture(scope="module")
def model():
    return pliant.Model(bar().robot, tolerance=1e-10)


@pytest.fixture(scope="module")
def state(model):
    return model.solve([0.058])


def tip(model, length):
    return model.solve([length]).markers()[0]


def test_the_jacobian_agrees_with_finite_differences(model, state):
    h = 1e-6
    measured = (tip(model, 0.058 + h) - tip(model, 0.058 - h)) / (2 * h)
    jacobian = model.jacobian(state)
    assert jacobian.shape == (1, 3, 1)
    assert np.linalg.norm(jacobian[0, :, 0] - measured) < 1e-5 * np.linalg.norm(measured)
    assert np.array_equal(jacobian, model.jacobian(state, ["tip"]))
    assert model.jacobian(state, []).shape == (0, 3, 1)


def test_the_gradient_agrees_with_the_jacobian(model, state):
    weights = np.array([0.3, -1, 2])
    gradient = model.grad(state, markers={"tip": weights})
    assert gradient.controls == pytest.approx(weights @ model.jacobian(state)[0], rel=1e-9)
    assert gradient.rest_positions.shape == (model.node_count, 3)
    assert gradient.guide_points.shape == (0, 3)
    at = model.linearise(state)
    wanted = pliant.Measure("marker", "tip", tuple(weights))
    assert at.gradient_of(wanted, guide_points=True).guide_points.shape == (len(at.guide_points), 3) == (3, 3)
    assert len(gradient.inputs) == len(at.inputs) and len(gradient.parameters) == len(at.parameters)
    assert at.inputs[0].name == 'cable "flexor": length' and at.inputs[0].value == pytest.approx(0.058)
    by_positions = np.zeros((model.node_count, 3))
    by_positions[5, 2] = 1
    response = at.response('cable "flexor": length')
    assert model.grad(state, positions=by_positions).controls[0] == pytest.approx(response.positions[5, 2], rel=1e-8)
    tension = model.grad(state, tensions=[1]).controls[0]
    assert tension == pytest.approx(response.tensions[0], rel=1e-8)
    assert tension < 0


def test_the_gradient_by_a_modulus_agrees_with_finite_differences(model, state):
    names = [p.name for p in model.linearise(state).parameters]
    modulus = names.index('material "soft": youngs_modulus')
    gradient = model.grad(state, tensions=[1]).parameters[modulus]
    h = 1e3

    def tension(youngs):
        other = pliant.Model(model.robot.changed({"material.soft.youngs_modulus": f"{youngs} Pa"}), tolerance=1e-10)
        return other.solve([0.058]).observe().cables["flexor"].tension_N

    assert gradient == pytest.approx((tension(1e6 + h) - tension(1e6 - h)) / (2 * h), rel=1e-5)


def test_gradients_by_guide_points_agree_with_finite_differences():
    places = [[1.3, 4.2, 8.1], [30.7, 5.4, 8.3], [58.2, 4.6, 8.4]]
    ends = [[31.7, 2.1, 1.4], [56.4, 3.7, 1.2]]

    def made(cable, spring):
        return bar(
            cable=[{"name": "flexor", "points": cable, "target": {"length_ratio": 0.95}}],
            spring=[{"name": "band", "points": spring, "stiffness": "40 N/m"}],
            program={"steps": 1, "tolerance": 1e-10},
        )

    tension = pliant.Measure("tension", "flexor")

    def judged(model, **options):
        return pliant.gradient(model, [tension], lambda step, values: (values[0], [1.0]), **options)

    found = judged(made(places, ends), guide_points=True)
    assert [p.name for p in found.guide_points][2:4] == ['cable "flexor": point 3', 'spring "band": point 1']
    assert found.guide_points[1].place == pytest.approx([0.0307, 0.0054, 0.0083], abs=1e-12)
    assert found.by_guide_points.shape == (5, 3)
    for k in (1, 4):

        def value(change, k=k):
            moved = [list(p) for p in places + ends]
            moved[k][2] += change
            return judged(made(moved[:3], moved[3:])).value

        assert found.by_guide_points[k, 2] == pytest.approx((value(0.01) - value(-0.01)) / 2e-5, rel=1e-4)
    assert judged(made(places, ends)).by_guide_points.shape == (0, 3)


def test_an_objective_without_slopes_has_a_gradient_of_zeros():
    model = bar(parameters={"height": 5}, program={"steps": 2})
    found = pliant.gradient(
        model,
        [pliant.Measure("marker", "tip", [0, 0, 1])],
        lambda step, values: (0.0, [0.0]),
        rest_positions=True,
        guide_points=True,
        tets=True,
        numbers=["height"],
    )
    assert found.value == 0 and found.values.shape == (2, 1)
    assert found.by_parameters.shape == (len(found.parameters),) and not found.by_parameters.any()
    assert found.by_rest_positions.shape == (model.node_count, 3) and not found.by_rest_positions.any()
    assert found.by_guide_points.shape == (3, 3) and not found.by_guide_points.any()
    assert found.by_numbers.tolist() == [0]
    assert "youngs_modulus" in [tet.name for tet in found.by_tets]
    assert all(tet.values.shape == (model.tet_count,) and not tet.values.any() for tet in found.by_tets)


def test_controls_are_the_first_inputs_whatever_their_names():
    model = bar(
        cable=[
            {"name": 'a": length', "points": [[0, 5, 9], [60, 5, 9]], "target": {"shortening": "4 mm"}},
            {"name": "a", "points": [[0, 5, 1], [60, 5, 1]], "target": {"tension": "1 N"}},
        ]
    )
    state = model.solve([0.058, 0.5])
    found = model.grad(state, markers={"tip": [0, 0, 1]})
    assert found.controls.tolist() == found.inputs[:2].tolist()
    jacobian = model.jacobian(state)
    assert jacobian.shape == (1, 3, 2) and jacobian[0, 2] == pytest.approx(found.controls, rel=1e-8)


def test_solutions_invert_products_also_transposed(model, state):
    at = model.linearise(state)
    v = np.sin(np.arange(at.size))
    assert np.allclose(at.solve(at.multiply(v)), v, rtol=1e-6, atol=1e-8)
    assert np.allclose(at.solve_transposed(at.multiply_transposed(v)), v, rtol=1e-6, atol=1e-8)
    assert at.change(v).positions.shape == (model.node_count, 3)


def test_scipy_minimises_with_our_gradient(model):
    optimize = pytest.importorskip("scipy.optimize")
    wanted = tip(model, 0.0573)

    def miss(lengths):
        state = model.solve(lengths)
        away = state.markers()[0] - wanted
        return 1e6 * away @ away, 2e6 * model.grad(state, markers={"tip": away}).controls

    found = optimize.minimize(miss, [0.059], jac=True, bounds=[(0.055, 0.06)], method="L-BFGS-B", tol=1e-12)
    assert found.x[0] == pytest.approx(0.0573, abs=1e-6)


def test_torch_differentiates_through_an_equilibrium(model):
    torch = pytest.importorskip("torch")
    lengths = torch.tensor([0.058], dtype=torch.float64, requires_grad=True)
    markers = pliant.torch.markers(model, lengths)
    assert markers.shape == (1, 3)
    (markers * torch.tensor([[0.3, -1, 2]])).sum().backward()
    weights = np.array([0.3, -1, 2])
    assert lengths.grad.numpy() == pytest.approx(weights @ model.jacobian(model.solve([0.058]))[0], rel=1e-8)
    assert torch.autograd.gradcheck(lambda x: 1e3 * pliant.torch.markers(model, x), [lengths], eps=1e-6, atol=1e-4)
    positions = pliant.torch.positions(model, lengths)
    assert positions.shape == (model.node_count, 3) and positions.requires_grad


def test_torch_refuses_the_gradient_of_a_gradient(model):
    torch = pytest.importorskip("torch")
    lengths = torch.tensor([0.058], dtype=torch.float64, requires_grad=True)
    for function in (pliant.torch.markers, pliant.torch.positions):
        (slope,) = torch.autograd.grad((function(model, lengths) ** 2).sum(), lengths, create_graph=True)
        with pytest.raises(RuntimeError, match="once_differentiable"):
            (slope**2).sum().backward()


def test_a_motion_has_gradients_by_its_dampings_and_by_torques():
    def found(damping=0.5, torque=0.02):
        model = bar(
            cable=[],
            plate=[{"name": "end", "box": [[60, 0, 0], [60, 10, 10]]}],
            load=[{"name": "twist", "plate": "end", "torque": ["0 N m", f"{torque} N m", "0 N m"]}],
            program={
                "duration": "0.04 s",
                "time_step": "10 ms",
                "mass_damping": damping,
                "stiffness_damping": 0.002,
                "tolerance": 1e-10,
            },
        )
        tip = pliant.Measure("marker", "tip", [0, 0, 1])
        return pliant.gradient(model, [tip], lambda step, values: (values[0], [1.0]))

    gradient = found()
    by = dict(zip([p.name for p in gradient.parameters], gradient.by_parameters))
    assert "damping by stiffness" in by
    for name, more, less, step in (
        ("damping by mass", found(damping=0.51), found(damping=0.49), 0.02),
        ('load "twist": torque, y', found(torque=0.0201), found(torque=0.0199), 0.0002),
    ):
        assert by[name] == pytest.approx((more.value - less.value) / step, rel=1e-3)
