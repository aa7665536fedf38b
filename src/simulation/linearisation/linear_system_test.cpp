// Ways to solve with a linearised state: by a factor, with an order of elimination that is known, on two levels.
#include "simulation/linearisation/linear_system.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "simulation/linearisation/test_robots.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::testing;

namespace {

Description driven() {
    Description d = block(1, material::neo_hookean(1e6, 0.45));
    d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.95})};
    d.chambers[0].target = {ChamberTarget::Kind::gas_ratio, 1.2};
    d.markers = {{"tip", d.cables[0].points.back()}};
    return d;
}

}  // namespace

TEST_CASE("a known pattern from a solver changes nothing but the time") {
    const Case c(driven());
    const FactoredLaplacian laplacian(c.system);
    const State state = disturbed(c.system, 0.5, 2e3);
    const Controls controls = c.system.controls(0.7);
    Linearisation at = c.at(state, controls);
    auto known = Linearisation::create(c.system, state, controls, known_pattern(c.system, laplacian, nullptr));
    REQUIRE(known);
    Noise noise(3);
    const Eigen::VectorXd w = some_direction(at, Side::transposed, noise), b = at.multiply_transposed(w);
    const auto x = at.solve_transposed(b), y = known->solve_transposed(b);
    REQUIRE(x);
    REQUIRE(y);
    CHECK((*x - w).norm() < 1e-9 * w.norm());
    CHECK((*y - w).norm() < 1e-9 * w.norm());
}

TEST_CASE("a known pattern without the contact couplings is not used") {
    Case c(touching_blocks());
    const Settled at = pressed(c.system);
    const FactoredLaplacian laplacian(c.system);
    auto known = Linearisation::create(c.system, at.state, at.controls, known_pattern(c.system, laplacian, nullptr));
    REQUIRE(known);
    Linearisation alone = c.at(at.state, at.controls);
    Noise noise(3);
    const Eigen::VectorXd v = noise.vector(alone.size());
    CHECK((known->multiply(v) - alone.multiply(v)).norm() <= 1e-13 * alone.multiply(v).norm());
}

TEST_CASE("on two levels products with a solution agree with exact ones to six digits") {
    const Case c(driven());
    const FactoredLaplacian laplacian(c.system);
    const State state = settle(c.system, 3, 0.1, 1e-8).state;
    const Controls controls = c.system.controls(0.3);
    Linearisation exact = c.at(state, controls);
    KnownPattern pattern = known_pattern(c.system, laplacian, nullptr);
    CHECK_FALSE(pattern.on_levels);
    pattern.on_levels = true;
    auto levels = Linearisation::create(c.system, state, controls, pattern);
    REQUIRE(levels);
    const Quantity tip = marker_coordinate(c.system, 0, {0, 0, 1});
    const auto w = exact.adjoint(tip), v = levels->adjoint(tip);
    REQUIRE(w);
    REQUIRE(v);
    for (const Parameter& p : parameters(exact)) {
        CAPTURE(p.name);
        const double told = w->derivative(derivative(exact, p)), found = v->derivative(derivative(*levels, p));
        const bool all_moves = p.kind == Parameter::Kind::support_move;  // by 1, sideways by nothing
        CHECK(found == near(told, {.relative = 1e-6, .absolute = all_moves ? 1e-8 : 0}));
    }
}

TEST_CASE("with fewer digits wanted, by factor or on two levels, gradients still have six") {
    const Case c(driven());
    const FactoredLaplacian laplacian(c.system);
    const State state = settle(c.system, 3, 0.1, 1e-8).state;
    const Controls controls = c.system.controls(0.3);
    Linearisation exact = c.at(state, controls);
    const Quantity tip = marker_coordinate(c.system, 0, {0, 0, 1});
    const auto told = exact.adjoint(tip);
    REQUIRE(told);
    for (const bool on_levels : {false, true}) {
        KnownPattern pattern = known_pattern(c.system, laplacian, nullptr);
        pattern.on_levels = on_levels;
        auto at = Linearisation::create(c.system, state, controls, pattern, gradient_residual);
        REQUIRE(at);
        const auto found = at->adjoint(tip);
        REQUIRE(found);
        const Eigen::VectorXd right = exact.multiply_transposed(told->weights);
        const double left = (at->multiply_transposed(found->weights) - right).norm() / right.norm();
        CHECK(left < (on_levels ? 1e-3 : 10 * gradient_residual));
        for (const Parameter& p : inputs(exact)) {
            CAPTURE(p.name);
            const double wanted = told->derivative(derivative(exact, p));
            CHECK(found->derivative(derivative(*at, p)) == near(wanted, {.relative = 1e-6, .absolute = 1e-14}));
        }
    }
}

TEST_CASE("cables with nearly equal effect are distinguished") {
    Description d = driven();
    d.chambers[0].target = {ChamberTarget::Kind::pressure_Pa, 0};
    d.cables.push_back(d.cables[0]);
    d.cables[1].name = "beside";
    for (Attachment& point : d.cables[1].points) {  // a hair away from the other
        if (point.nodes.size() == 1) continue;
        point.weights[0] += 1e-4;
        point.weights[1] -= 1e-4;
    }
    const Case c(std::move(d));
    const State state = disturbed(c.system, 0.5, 2e3);
    Linearisation at = c.at(state, c.system.controls(0.7));
    Noise noise(3);
    const Eigen::VectorXd v = some_direction(at, Side::direct, noise);
    const auto x = at.solve(at.multiply(v));
    REQUIRE_MESSAGE(x, x.error().message);
    CHECK((at.multiply(*x) - at.multiply(v)).norm() < 1e-11 * at.multiply(v).norm());
}
