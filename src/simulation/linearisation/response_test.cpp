// Predictions of a linearisation against two simulations, and the same bits on any number of threads.
#include <doctest/doctest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "base/core/near.hpp"
#include "simulation/linearisation/test_differences.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::testing;

namespace {

constexpr double side = 0.01;

/// A hollow block that a cable bends and air fills, under gravity.
Description arm(double shortened_m, double air_m3) {
    Description d = hollow_block(1);
    const int high =
        reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 3 * side - 1e-9 && p.z > side - 1e-9; })[2];
    const int low = reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9 && p.z > side - 1e-9; })[2];
    d.cables = {{"flexor", {{{low}, {1.0}, {}}, {{high}, {1.0}, {}}}, {CableTarget::Kind::shortening_m, shortened_m}}};
    d.chambers[0].target = {ChamberTarget::Kind::volume_change_m3, air_m3};
    d.gravity_m_s2 = {0, -9.81, 0};
    return d;
}

const Program program{.steps = 3, .tolerance = 1e-11, .solver = Solver::newton, .checks = false};
constexpr double shortened = 0.15 * side, air = 2e-8;

Step end_of(double shortened_m, double air_m3) {
    const Trajectory result = solve(arm(shortened_m, air_m3), program);
    REQUIRE_MESSAGE(result.converged, result.message);
    return result.steps.back();
}

State state_of(const Step& step, const Equilibrium& system) {
    State state = system.rest();
    for (std::size_t n = 0; n < step.positions.size(); ++n)
        state.x.segment<3>(3 * static_cast<Eigen::Index>(n)) = linalg::vector(step.positions[n]);
    state.multiplier << step.cables[0].tension_N, -step.chambers[0].pressure_Pa;
    return state;
}

}  // namespace

TEST_CASE("derivatives of tip and tension by cable length and chamber volume agree with simulations") {
    const auto model = Model::create(arm(shortened, air));
    REQUIRE(model);
    const Equilibrium system(*model);
    auto at = Linearisation::create(system, state_of(end_of(shortened, air), system), system.controls(1));
    REQUIRE(at);
    const std::vector<Parameter> all = inputs(*at);
    REQUIRE(all[0].name == "cable \"flexor\": length");
    REQUIRE(all[1].name == "chamber \"air\": volume");
    const double h = 1e-4 * side, h_m3 = 1e-10;
    const Step shorter = end_of(shortened + h, air), longer = end_of(shortened - h, air);
    const Step fuller = end_of(shortened, air + h_m3), emptier = end_of(shortened, air - h_m3);
    const auto marker = [](const Step& s) { return linalg::vector(s.markers[0].position_m); };
    const Eigen::Vector3d by_length = (marker(longer) - marker(shorter)) / (2 * h);
    const Eigen::Vector3d by_volume = (marker(fuller) - marker(emptier)) / (2 * h_m3);
    for (int c = 0; c < 3; ++c) {
        const Eigen::Vector3d axis = Eigen::Vector3d::Unit(c);
        const Quantity tip = marker_coordinate(system, 0, {axis[0], axis[1], axis[2]});
        const auto adjoint = at->adjoint(tip);
        REQUIRE(adjoint);
        CHECK(adjoint->derivative(derivative(*at, all[0])) ==
              near(by_length[c], {.absolute = 1e-6 * by_length.norm()}));
        CHECK(adjoint->derivative(derivative(*at, all[1])) ==
              near(by_volume[c], {.absolute = 1e-6 * by_volume.norm()}));
        const auto change = at->response(derivative(*at, all[0]));
        REQUIRE(change);
        CHECK(tip.derivative(*change) == near(by_length[c], {.absolute = 1e-6 * by_length.norm()}));
    }
    const auto tension = at->adjoint(multiplier_of(system, 0));
    REQUIRE(tension);
    const double tension_by_length = (longer.cables[0].tension_N - shorter.cables[0].tension_N) / (2 * h);
    const double tension_by_volume = (fuller.cables[0].tension_N - emptier.cables[0].tension_N) / (2 * h_m3);
    CHECK(tension->derivative(derivative(*at, all[0])) == near(tension_by_length, {.relative = 1e-5}));
    CHECK(tension->derivative(derivative(*at, all[1])) == near(tension_by_volume, {.relative = 1e-5}));
    const auto pressure = at->adjoint(multiplier_of(system, 1));
    REQUIRE(pressure);
    const double by_volume_Pa = -(fuller.chambers[0].pressure_Pa - emptier.chambers[0].pressure_Pa) / (2 * h_m3);
    CHECK(pressure->derivative(derivative(*at, all[1])) == near(by_volume_Pa, {.relative = 1e-5}));
}

TEST_CASE("a linearisation has the same bits on any number of threads") {
    const auto on_threads = [](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        Description d = arm(shortened, air);
        d.materials[0].law = material::shape_blend(1e5, 0.4);
        const auto model = Model::create(std::move(d));
        REQUIRE(model);
        const Equilibrium system(*model);
        State state = system.rest();
        Noise noise(3);
        for (double& entry : state.x) entry += 0.02 * side * noise();
        state.multiplier << 0.1, -100;
        auto at = Linearisation::create(system, state, system.controls(1));
        REQUIRE(at);
        const auto x = at->solve(noise.vector(at->size())), y = at->solve_transposed(noise.vector(at->size()));
        REQUIRE(x);
        REQUIRE(y);
        Eigen::VectorXd all(4 * at->size());
        all << *x, *y, at->multiply(*y), derivative(*at, inputs(*at).back()).equations;
        return all;
    };
    const Eigen::VectorXd first = on_threads(1);
    for (const std::size_t threads : {1, 2, 4}) {
        const Eigen::VectorXd again = on_threads(threads);
        CHECK(std::memcmp(first.data(), again.data(), sizeof(double) * static_cast<std::size_t>(first.size())) == 0);
    }
}
