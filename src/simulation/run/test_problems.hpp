// Shared by several tests of the solver.
#pragma once

#include <doctest/doctest.h>

#include <utility>

#include "simulation/actuators/attach.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/simulate.hpp"

namespace pliant::sim::testing {

inline constexpr double mm = 1e-3;  ///< in metres

/// The model of a valid description.
inline Model model_of(Description d) {
    auto model = Model::create(std::move(d));
    REQUIRE_MESSAGE(model, (model ? "" : model.error().message));
    return std::move(*model);
}

/// Runs a valid description; the test must check whether it converged.
inline Trajectory solve(Description d, const Program& program) {
    const Model model = model_of(std::move(d));
    Progress silent;
    return run(model, program, silent);
}

inline constexpr double block_side = 0.01;

/// A block of 3 x 1 x 1 cm, E = 0.1 MPa, with an empty box in the middle, clamped at x = 0. The chamber has the default
/// target, the marker is the mean of the free end.
inline Description hollow_block(int order, double nu = 0.4) {
    const auto void_at = [](Vec3 c) {
        const auto inside = [](double v, double low, double high) { return v > low && v < high; };
        return inside(c.x, 0.005, 0.025) && inside(c.y, 0.0025, 0.0075) && inside(c.z, 0.0025, 0.0075) ? 1 : 0;
    };
    mesh::TetMesh whole = reference::kuhn_box({3 * block_side, block_side, block_side}, 6, 4, 4, void_at);
    whole.region_names = {"solid", "air"};
    if (order == 2) whole = mesh::to_quadratic(whole);
    mesh::Extract solid = mesh::extract_regions(whole, {true, false});
    Description d;
    d.mesh = std::move(solid.mesh);
    d.materials = {{"A", material::neo_hookean(1e5, nu), 1000}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    d.chambers.push_back({"air", wall_of_faces(whole, mesh::region_faces(whole, 1), solid.node), {}});
    d.markers = {{"tip", reference::mean_of(
                             reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 3 * block_side - 1e-9; }))}};
    return d;
}

}  // namespace pliant::sim::testing
