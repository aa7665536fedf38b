// Derivatives with respect to rest positions, against robots of another shape.
#include "simulation/linearisation/rest_positions.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "simulation/linearisation/test_robots.hpp"
#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::testing;

namespace {

/// The controls of a robot; its targets have the same values as those of the first.
using ControlsOf = std::function<Controls(Equilibrium&)>;

Description reshaped(Description d, const Eigen::VectorXd& motion, double step) {
    for (std::size_t n = 0; n < d.mesh.points.size(); ++n) {
        for (std::size_t c = 0; c < 3; ++c) d.mesh.points[n][c] += step * motion[static_cast<Eigen::Index>(3 * n + c)];
    }
    return d;
}

double worst_error(Case& c, State state, const ControlsOf& controls_of) {
    c.system.place_supports(controls_of(c.system), state.x);
    Linearisation at = c.at(state, controls_of(c.system));
    Noise noise(9);
    const Eigen::VectorXd weights = some_direction(at, Side::transposed, noise);
    const Eigen::VectorXd motion = noise.vector(state.x.size());
    const Quantity quantity{noise.vector(state.x.size()), Eigen::VectorXd::Zero(state.multiplier.size())};
    const auto by = derivative_by_rest(at, motion);
    const auto gradient = rest_gradient(at, {quantity, weights});
    const double direct = quantity.derivative(by.direct), bent = weights.dot(by.equations);
    CHECK(gradient.dot(motion) ==
          near(direct - bent, {.absolute = 1e-12 * (std::fabs(direct) + weights.norm() * by.equations.norm())}));
    const Eigen::VectorXd least = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(at.solved().size()), 1e-9);
    return best_error(0.01 * edge, [&](double h) {
        const auto equations = [&](double step) {
            Case other(reshaped(c.model.description(), motion, step));
            Controls controls = controls_of(other.system);
            controls.drives = at.controls().drives;
            State moved = at.state();
            other.system.place_supports(controls, moved.x);
            return at.equations(other.system, moved, controls);
        };
        return relative_error(at, difference(equations, h), by.equations, least);
    });
}

const ControlsOf at_70_percent = [](Equilibrium& system) { return system.controls(0.7); };

}  // namespace

TEST_CASE("derivatives by rest positions for every law, both orders, with weight, plate, springs and actuators") {
    double worst = 0;
    for (const int order : {1, 2}) {
        for (const auto& [name, law] : laws) {
            CAPTURE(name);
            CAPTURE(order);
            Description d = block(order, law);
            d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.95})};
            d.chambers[0].target = {ChamberTarget::Kind::gas_ratio, 1.2};
            d.plates = {{"plate", end_of(d.mesh)}};
            d.springs = {{"free", d.cables[0].points, 300}, {"long", d.cables[0].points, 100, edge}};
            d.gravity_m_s2 = {0, 3, -9.81};
            Case c(std::move(d));
            const double error = worst_error(c, disturbed(c.system, 0.5, 2e3), at_70_percent);
            CHECK(error < 1e-7);
            worst = std::max(worst, error);
        }
    }
    MESSAGE("rest positions: ", worst);
}

TEST_CASE("derivatives by rest positions with turning supports, shared rollers and pressure on a patch") {
    Description d = plain();
    d.supports[0].turn = {0.2, {1, 2, 0}, {0, 0, edge}};
    d.supports.push_back(
        {"roller", end_of(d.mesh), {0.02 * edge, 0, 0.01 * edge}, ramp(0, 1), {0.1, {1, 1, 0}, {}}, {{0, 1, 1}}});
    d.supports.push_back({"symmetry",
                          reference::nodes_where(d.mesh, [](Vec3 p) { return p.y < 1e-9 && p.x > 1e-9; }),
                          {},
                          ramp(0, 1),
                          {},
                          {{1, 0, 0}}});
    d.pressures = {patch(d.mesh, -1)};
    d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.95})};
    Case c(std::move(d));
    REQUIRE_FALSE(c.system.rollers().empty());
    CHECK(worst_error(c, disturbed(c.system, 0.5, 0), at_70_percent) < 1e-7);
}

TEST_CASE("derivatives by rest positions for a step in time") {
    Description d = plain(2);
    d.gravity_m_s2 = {0, 3, -9.81};
    Case c(std::move(d));
    const State before = disturbed(c.system, 0, 0, 4), rest = c.system.rest();
    const History history{before.x, before.x - rest.x, rest.x, before.x, 0};
    const double error = worst_error(c, disturbed(c.system, 0, 0), [&](Equilibrium& system) {
        Controls controls = system.controls(0.7);
        controls.inertia = std::make_shared<const Inertia>(system.model().elements(), system.model().free_index(),
                                                           history, 1e-3, Damping{2, 0}, nullptr);
        return controls;
    });
    CHECK(error < 1e-7);
}

TEST_CASE("derivatives by rest positions with two gaps that one cable closes, both orders") {
    for (const int order : {1, 2}) {
        Description d = plain(order);
        d.materials.push_back({"gap", gap_law(1e6), 0});
        d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.9})};
        d.mesh.region_names = {"solid", "gap", "wide gap"};
        d.materials.push_back(d.materials[1]);
        d.material_of_region = {0, 1, 2};
        for (std::size_t t = 0; t < 7; ++t) d.mesh.region[t] = t < 4 ? 1 : 2;
        d.growths = {{1, {1, 0, 0}, 0, 1e5, edge, {1.5 * edge, 0.5 * edge, 0.9 * edge}},
                     {2, {0.8, 0.6, 0}, 0, 3e5, 0.5 * edge, {1.5 * edge, 0.5 * edge, 0.9 * edge}}};
        Case c(std::move(d));
        CHECK(worst_error(c, disturbed(c.system, 0.5, 0), at_70_percent) < 1e-7);
    }
}

TEST_CASE("the derivative of the tip by rest positions agrees with simulations of other shapes") {
    // The length is wanted as a ratio, so it changes with the shape too.
    Description d = hollow_block(1);
    d.chambers.clear();
    const auto corner = [&](double x) {
        return reference::nodes_where(d.mesh,
                                      [&](Vec3 p) { return std::fabs(p.x - x) < 1e-9 && p.z > edge - 1e-9; })[2];
    };
    d.cables = {{"flexor",
                 {{{corner(0)}, {1.0}, {}}, {{corner(3 * edge)}, {1.0}, {}}},
                 {CableTarget::Kind::length_ratio, 0.95}}};
    d.gravity_m_s2 = {0, 0, -9.81};
    const Program program{.steps = 2, .tolerance = 1e-11, .solver = Solver::newton, .checks = false};
    const auto end = [&](const Description& of) {
        const Trajectory result = solve(of, program);
        REQUIRE_MESSAGE(result.converged, result.message);
        return result.steps.back();
    };
    Case c(d);
    const Step last = end(d);
    State state = c.system.rest();
    for (std::size_t n = 0; n < last.positions.size(); ++n)
        state.x.segment<3>(3 * static_cast<Eigen::Index>(n)) = linalg::vector(last.positions[n]);
    state.multiplier << last.cables[0].tension_N;
    Linearisation at = c.at(state, c.system.controls(1));
    Noise noise(2);
    const Eigen::VectorXd motion = noise.vector(state.x.size());
    const double h = 1e-4 * edge;
    const Vec3 ahead = end(reshaped(d, motion, h)).markers[0].position_m;
    const Vec3 back = end(reshaped(d, motion, -h)).markers[0].position_m;
    const auto adjoint = at.adjoint(marker_coordinate(c.system, 0, {0, 0, 1}));
    REQUIRE(adjoint);
    const double by_length = adjoint->derivative(derivative(at, inputs(at)[0]));
    const double told =
        rest_gradient(at, *adjoint).dot(motion) + 0.95 * by_length * rest_measure_gradient(c.system, 0).dot(motion);
    CHECK(told == near((ahead.z - back.z) / (2 * h), {.relative = 1e-6}));
}
