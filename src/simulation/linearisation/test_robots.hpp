// Small robots for the tests of linearisations.
#pragma once

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <string_view>
#include <utility>
#include <vector>

#include "simulation/actuators/attach.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/linearisation/test_differences.hpp"
#include "simulation/peers/reference_problems.hpp"

namespace pliant::sim::testing {

inline constexpr double edge = 0.01;

inline const std::vector<std::pair<const char*, material::Law>> laws = {
    {"neo-hookean", material::neo_hookean(1e6, 0.4)},
    {"shape-blend", material::shape_blend(1e6, 0.4)},
    {"shape-blend, rigid", material::ShapeBlend{1e6, 1.0}},
    {"st-venant-kirchhoff", material::st_venant_kirchhoff(1e6, 0.3)},
    {"mooney-rivlin", material::MooneyRivlin{1.2e5, 0.5e5, 18e5}},
    {"yeoh", material::Yeoh{1.2e5, -0.1e5, 0.02e5, 18e5}},
    {"ogden", material::Ogden{2, {1.5e5, -0.3e5}, {1.3, -2.0}, 18e5}},
    {"corotated", material::corotated(1e6, 0.4)},
    {"linear", material::linear(1e6, 0.4)},
};

/// A clamped block with an empty box in the middle.
inline Description block(int order, const material::Law& law) {
    const auto region = [](Vec3 c) {
        const auto inside = [](double v, double low, double high) { return v > low && v < high; };
        return inside(c.x, edge, 2 * edge) && inside(c.y, edge / 3, 2 * edge / 3) && inside(c.z, edge / 3, 2 * edge / 3)
                   ? 1
                   : 0;
    };
    mesh::TetMesh whole = reference::kuhn_box({3 * edge, edge, edge}, 3, 3, 3, region);
    whole.region_names = {"solid", "air"};
    if (order == 2) whole = mesh::to_quadratic(whole);
    mesh::Extract solid = mesh::extract_regions(whole, {true, false});
    Description d;
    d.mesh = std::move(solid.mesh);
    d.materials = {{"A", law, 1000}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    d.chambers.push_back({"air", wall_of_faces(whole, mesh::region_faces(whole, 1), solid.node), {}});
    return d;
}

/// A cable through the nodes nearest to these points.
inline Cable cable_through(const mesh::TetMesh& mesh, std::vector<Vec3> points, const CableTarget& target) {
    Cable cable{"c", {}, target};
    const Attacher attacher(mesh);
    for (const Vec3& p : points) cable.points.push_back(*attacher.carried_by_tet(p, 1e-6));
    return cable;
}

inline Cable flexor(const mesh::TetMesh& mesh, const CableTarget& target) {
    return cable_through(mesh,
                         {{0.1 * edge, 0.5 * edge, 0.9 * edge},
                          {1.5 * edge, 0.6 * edge, 0.95 * edge},
                          {2.9 * edge, 0.5 * edge, 0.9 * edge}},
                         target);
}

/// Random displacements of all nodes, including held ones, by up to a fraction of an element.
inline State disturbed(const Equilibrium& system, double tension, double pressure, unsigned seed = 3) {
    State state = system.rest();
    Noise noise(seed);
    for (double& entry : state.x) entry += 0.04 * edge * noise();
    for (std::size_t a = 0; a < system.actuators().size(); ++a)
        state.multiplier[static_cast<Eigen::Index>(a)] = a < system.cable_count() ? tension : -pressure;
    return state;
}

struct Case {
    Model model;
    Equilibrium system;
    explicit Case(Description d) : model(make(std::move(d))), system(model) {}
    static Model make(Description d) {
        auto made = Model::create(std::move(d));
        REQUIRE_MESSAGE(made, (made ? "" : made.error().message));
        return std::move(*made);
    }
    [[nodiscard]] Linearisation at(const State& state, const Controls& controls) const {
        auto made = Linearisation::create(system, state, controls);
        REQUIRE_MESSAGE(made, (made ? "" : made.error().message));
        return std::move(*made);
    }
};

inline Description plain(int order = 1) {
    Description d = block(order, material::neo_hookean(1e6, 0.4));
    d.chambers.clear();
    return d;
}

inline std::vector<int> end_of(const mesh::TetMesh& mesh) {
    return reference::nodes_where(mesh, [](Vec3 p) { return p.x > 3 * edge - 1e-9; });
}

/// The top, as a wall whose rim is free except at the clamp.
inline PressureLoad patch(const mesh::TetMesh& mesh, double from) {
    const auto all = mesh::boundary_faces(mesh);
    std::vector<mesh::Face> faces;
    for (const mesh::Face& face : all) {
        bool inside = true;
        for (int k = 0; k < 3; ++k) {
            const Vec3& p = mesh.points[static_cast<std::size_t>(face.nodes[static_cast<std::size_t>(k)])];
            inside = inside && p.z > edge - 1e-9 && p.x > from;
        }
        if (inside) faces.push_back(face);
    }
    std::vector<int> same(mesh.points.size());
    for (std::size_t i = 0; i < same.size(); ++i) same[i] = static_cast<int>(i);
    return {"gust", wall_of_faces(mesh, faces, same), 3e3};
}

/// A block above a table, and a second one that hangs above the first.
inline Description touching_blocks() {
    mesh::TetMesh mesh = reference::kuhn_box({2 * edge, edge, edge}, 4, 2, 2, [](Vec3) { return 0; });
    const std::size_t lower = mesh.points.size();
    const auto nodes = mesh.nodes;
    for (std::size_t i = 0; i < lower; ++i)
        mesh.points.push_back(mesh.points[i] + Vec3{0.13 * edge, 0.07 * edge, 1.05 * edge});
    for (const int node : nodes) mesh.nodes.push_back(node + static_cast<int>(lower));
    mesh.region.resize(2 * mesh.region.size(), 0);
    Description d;
    d.mesh = std::move(mesh);
    d.materials = {{"A", material::neo_hookean(1e6, 0.4), 1000}};
    d.material_of_region = {0};
    d.supports = {
        {"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 0.14 * edge; }), {0, 0, 0.05 * edge}}};
    ContactRules rules;
    rules.surface = contact::robot_surface(d.mesh);
    rules.settings = {0.1 * edge, 1e5, 0.4, 0.1 * edge, true};
    const contact::HalfSpace table{{0, 0, -0.2 * edge}, {0, 0.1, 1}};
    rules.obstacles.push_back({{"table", table, 0.3}, {0.02 * edge, 0, 0.24 * edge}});
    d.contact = std::move(rules);
    return d;
}

/// Touching blocks that have slid a little, with friction frozen there.
inline Settled pressed(Equilibrium& system) {
    State state = system.rest();
    Noise noise(5);
    for (double& entry : state.x) entry += 0.003 * edge * noise();
    for (Eigen::Index i = state.x.size() / 6; i < state.x.size() / 3; ++i) state.x[3 * i + 2] -= 0.035 * edge;
    Controls controls = system.controls(0.9);
    system.place_supports(controls, state.x);
    State start = state;
    for (double& entry : start.x) entry += 0.02 * edge * noise();
    controls.friction = system.freeze_friction(state, start, controls, system.controls(0.8));
    REQUIRE(system.evaluate(state, controls).possible());
    return {std::move(state), std::move(controls)};
}

}  // namespace pliant::sim::testing
