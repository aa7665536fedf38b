// The cable finger against CalculiX (fem/README.md of the reference data).
#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;
using testing::mm;

namespace {

/// The finger with a cable of 14 points through mesh nodes, driven to one length ratio.
Description finger(const reference::NamedMesh& named, double nu, double ratio) {
    Description d;
    d.mesh = named.mesh;
    d.materials = {{"x < 49", material::neo_hookean(45e6, nu), 0}, {"x > 49", material::neo_hookean(45e6, nu), 0}};
    d.material_of_region = {0, 1};
    d.supports = {{"L", named.sets.at("L"), {}}};
    Cable cable{"cable", {}, {CableTarget::Kind::length_ratio, ratio}};
    for (const int node : named.sets.at("cable")) cable.points.push_back({{node}, {1.0}, {}});
    d.cables = {cable};
    d.markers = {{"tip", reference::mean_of(named.sets.at("tip"))}};
    return d;
}

/// Tension and tip displacement at an exact length ratio.
void check(const reference::NamedMesh& named, double nu, double ratio, double tension, Vec3 tip_mm, double tolerance,
           double residual = 1e-5, Solver solver = Solver::automatic) {
    CAPTURE(ratio);
    auto model = Model::create(finger(named, nu, ratio));
    REQUIRE(model);
    Progress silent;
    Program program;
    program.steps = std::max(1, static_cast<int>(std::lround((1 - ratio) * 100)));
    program.tolerance = residual;
    program.solver = solver;
    const Trajectory result = run(*model, program, silent);
    REQUIRE_MESSAGE(result.converged, result.message);
    const Step& last = result.steps.back();
    Vec3 rest;
    for (const int node : named.sets.at("tip"))
        rest += named.mesh.points[node] / static_cast<double>(named.sets.at("tip").size());
    const Vec3 tip = (last.markers[0].position_m - rest) / mm;
    CHECK(last.cables[0].length_ratio == near(ratio, {.relative = 1e-6}));
    CHECK(last.cables[0].tension_N == near(tension, {.relative = tolerance}));
    CHECK(tip.z == near(tip_mm.z, {.relative = tolerance}));
    CHECK(tip.x == near(tip_mm.x, {.relative = tolerance}));
    CHECK(last.min_J > 0);
}

}  // namespace

TEST_CASE("cable finger, linear tets: tension and tip agree with CalculiX within 0.1 %") {
    const auto named = reference::load_tet(reference::data_folder() + "/fem/finger_p1_8563.tet", mm);
    int rows = 0;
    for (const auto& row : reference::load_csv(reference::data_folder() + "/fem/ccx_finger_cable.csv")) {
        if (row.at("elem") != "C3D4") continue;
        ++rows;
        check(named, std::stod(row.at("nu")), std::stod(row.at("S_cable_length_ratio")),
              std::stod(row.at("cable_tension_N")), {std::stod(row.at("tip_ux_mm")), 0, std::stod(row.at("tip_uz_mm"))},
              1e-3);
    }
    CHECK(rows == 5);
}

TEST_CASE("cable finger, linear tets: agrees to five digits with an independent solver") {
    const auto named = reference::load_tet(reference::data_folder() + "/fem/finger_p1_8563.tet", mm);
    check(named, 0.45, 0.95, 36.59042, {-8.51257, 0, 27.24588}, 2e-5, 1e-7);
    check(named, 0.45, 0.80, 132.22907, {-74.04073, 0, 59.79902}, 2e-5, 1e-7);
    check(named, 0.45, 0.70, 184.60587, {-106.59362, 0, 37.41395}, 2e-5, 1e-7);
}

TEST_CASE("cable finger: the quasi-Newton solver gives the same answer") {
    const auto named = reference::load_tet(reference::data_folder() + "/fem/finger_p1_8563.tet", mm);
    check(named, 0.45, 0.95, 36.59042, {-8.51257, 0, 27.24588}, 1e-3, 1e-5, Solver::quasi_newton);
}
