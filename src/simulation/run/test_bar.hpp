// The clamped bar with a cable of several tests of the solver.
#pragma once

#include <doctest/doctest.h>

#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/simulate.hpp"

namespace pliant::sim::testing {

inline constexpr double bar_side = 0.01;

/// A bar of 4 x 1 x 1 cm along x, clamped at x = 0; its marker is the mean of the free end.
inline Description bar(int order, const material::Law& law = material::neo_hookean(1e6, 0.4)) {
    Description d;
    d.mesh = reference::kuhn_box({4 * bar_side, bar_side, bar_side}, 8, 2, 2, [](Vec3) { return 0; });
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"A", law, 1000}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    d.markers = {
        {"tip", reference::mean_of(reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 4 * bar_side - 1e-9; }))}};
    return d;
}

/// A cable along the upper side of the bar, through nodes of the mesh, from a point fixed in space.
inline Cable flexor(const mesh::TetMesh& mesh, CableTarget target) {
    Cable cable{"flexor", {{{}, {}, {0, bar_side / 2, bar_side}}}, target};
    for (int k = 1; k <= 4; ++k) {
        const auto nodes = reference::nodes_where(mesh, [&](Vec3 p) {
            return norm(p - Vec3{k * bar_side, bar_side / 2, bar_side}) < 1e-9;
        });
        REQUIRE(nodes.size() == 1);
        cable.points.push_back({nodes, {1.0}, {}});
    }
    return cable;
}

}  // namespace pliant::sim::testing
