// Gradients at one state against slightly different robots that are converged anew.
#include "simulation/gradient/variation.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <span>

#include "base/core/near.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/gradient/test_reconverged.hpp"
#include "simulation/peers/reference_problems.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::testing;

namespace {

/// Largest errors of the derivatives of all measures.
struct Worst {
    double inputs = 0, parameters = 0;
};

Eigen::MatrixXd gradients(Linearisation& at, const std::vector<Slope>& slopes, const By& by,
                          const std::function<Eigen::VectorXd(const Variation&)>& part) {
    Eigen::MatrixXd rows;
    for (std::size_t k = 0; k < slopes.size(); ++k) {
        const auto variation = gradient(at, slopes[k], by);
        REQUIRE_MESSAGE(variation, variation.error().message);
        const Eigen::VectorXd row = part(*variation);
        rows.conservativeResize(static_cast<Eigen::Index>(slopes.size()), row.size());
        rows.row(static_cast<Eigen::Index>(k)) = row;
    }
    return rows;
}

/// By all inputs and all numbers of the robot.
Worst errors_of(Case& c, const State& state, const ControlsOf& controls_of) {
    const Controls controls = controls_of(c.system);
    Linearisation at = c.at(settled_from(c.system, controls, state), controls);
    const std::vector<Measure> measures = all_measures(c.model.description());
    std::vector<Slope> slopes;
    for (const Measure& m : measures) slopes.push_back(slope(at, m));
    const Eigen::VectorXd values = sizes_of(at, slopes);
    const Eigen::MatrixXd by_inputs = gradients(at, slopes, {}, [](const Variation& v) { return v.inputs; });
    const Eigen::MatrixXd by_parameters = gradients(at, slopes, {}, [](const Variation& v) { return v.parameters; });
    Worst worst;
    const std::vector<Parameter> wanted = inputs(at), made_of = parameters(at);
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        const double error = gradient_error(by_inputs.col(static_cast<Eigen::Index>(k)), values,
                                            wanted[k].value != 0 ? std::fabs(wanted[k].value) : 1, [&](double change) {
                                                State moved = at.state();
                                                const Controls with = with_input(at, wanted[k], change, moved);
                                                return values_of(c.system, with, moved, measures);
                                            });
        INFO(wanted[k].name);
        CHECK(error < 1e-6);
        worst.inputs = std::max(worst.inputs, error);
    }
    for (std::size_t k = 0; k < made_of.size(); ++k) {
        const Parameter& p = made_of[k];
        const double error =
            gradient_error(by_parameters.col(static_cast<Eigen::Index>(k)), values, size_of(p), [&](double change) {
                Case other(with_value(c.model.description(), p, p.value + change));
                Controls with = controls_of(other.system);
                if (p.kind == Parameter::Kind::ambient_pressure) with.drives = at.controls().drives;
                return values_of(other.system, with, at.state(), measures);
            });
        INFO(p.name);
        CHECK(error < 1e-6);
        worst.parameters = std::max(worst.parameters, error);
    }
    return worst;
}

/// Many things at once, on a hollow block.
Description everything(int order) {
    Description d = block(order, material::neo_hookean(1e6, 0.4));
    for (std::size_t t = 0; t < d.mesh.tet_count(); ++t) d.mesh.region[t] = t % 3 == 0 ? 1 : 0;
    d.mesh.region_names = {"A", "B"};
    d.materials.push_back({"B", material::MooneyRivlin{1.2e5, 0.5e5, 18e5}, 1200});
    d.material_of_region = {0, 1};
    d.chambers[0].target = {ChamberTarget::Kind::gas_ratio, 1.2};
    d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.97})};
    d.springs = {{"coil", d.cables[0].points, 30, 0.8 * 3 * edge},
                 {"band", {d.cables[0].points[0], d.cables[0].points[1]}, 10, std::nullopt, true},
                 {"tie", {d.cables[0].points[0], d.cables[0].points.back()}, 20}};  // its length at rest is free
    const std::vector<int> end = end_of(d.mesh);
    d.loads = {{"hook", end, std::vector<double>(end.size(), 1.0 / static_cast<double>(end.size())), {0.1, 0, -0.3}}};
    d.pressures = {patch(d.mesh, -1)};
    d.gravity_m_s2 = {0, 3, -9.81};
    d.supports[0].turn = {0.2, {1, 2, 0}, {0, 0, edge}};
    d.supports.push_back({"symmetry",
                          reference::nodes_where(d.mesh, [](Vec3 p) { return p.y < 1e-9 && p.x > 2.9 * edge; }),
                          {0, 0.01 * edge, 0},
                          ramp(0, 1),
                          {},
                          {{0, 1, 0.2}}});
    d.markers = {{"tip", d.cables[0].points.back()}};
    return d;
}

/// A block with a chamber that a flange closes: the block slides on it, and its other end is clamped.
Description open_ended(int order) {
    const auto region = [](Vec3 c) {
        const auto inside = [](double v) { return v > edge / 3 && v < 2 * edge / 3; };
        return c.x < edge && inside(c.y) && inside(c.z) ? 1 : 0;
    };
    mesh::TetMesh whole = reference::kuhn_box({3 * edge, edge, edge}, 3, 3, 3, region);
    whole.region_names = {"solid", "air"};
    if (order == 2) whole = mesh::to_quadratic(whole);
    mesh::Extract solid = mesh::extract_regions(whole, {true, false});
    Description d;
    d.mesh = std::move(solid.mesh);
    d.materials = {{"A", material::neo_hookean(1e6, 0.4), 1000}};
    d.material_of_region = {0};
    std::vector<mesh::Face> faces = mesh::region_faces(whole, 1);
    const auto mouth = std::stable_partition(faces.begin(), faces.end(), [&](const mesh::Face& face) {
        return std::ranges::any_of(std::span(face.nodes).first(3),
                                   [&](int node) { return whole.points[static_cast<std::size_t>(node)].x > 1e-9; });
    });
    d.chambers.push_back({"air", wall_of_faces(whole, faces, solid.node), {ChamberTarget::Kind::gas_ratio, 1.3}});
    d.chambers[0].wall.mouth_faces = static_cast<std::size_t>(faces.end() - mouth);
    d.supports = {
        {"flange", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}, ramp(0, 1), {}, {{1, 0, 0}}},
        {"clamp", end_of(d.mesh), {}}};
    // So that no motion of the clamp moves the block as a whole.
    d.springs = {{"coil", {flexor(d.mesh, {}).points[1], {{}, {}, {0, -edge, 2 * edge}}}, 200, 0.5 * edge}};
    return d;
}

const ControlsOf at_50_percent = [](Equilibrium& system) { return system.controls(0.5); };

}  // namespace

TEST_CASE("derivatives with cable, sealed chamber, springs, loads, moving supports and two laws, both orders") {
    for (const int order : {1, 2}) {
        CAPTURE(order);
        Case c(everything(order));
        const Worst worst = errors_of(c, c.system.rest(), at_50_percent);
        MESSAGE("order ", order, ": inputs ", worst.inputs, ", parameters ", worst.parameters);
    }
}

TEST_CASE("derivatives with a chamber whose mouth slides on the support that closes it, both orders") {
    for (const int order : {1, 2}) {
        CAPTURE(order);
        Case c(open_ended(order));
        const Worst worst = errors_of(c, c.system.rest(), at_50_percent);
        MESSAGE("order ", order, ": inputs ", worst.inputs, ", parameters ", worst.parameters);
    }
}

TEST_CASE("derivatives for every law") {
    Worst all;
    for (const auto& [name, law] : laws) {
        CAPTURE(name);
        Description d = plain();
        d.materials[0].law = law;
        d.gravity_m_s2 = {0, 0, -9.81};
        d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.98})};
        d.markers = {{"tip", d.cables[0].points.back()}};
        Case c(std::move(d));
        const Worst worst = errors_of(c, c.system.rest(), at_50_percent);
        all = {std::max(all.inputs, worst.inputs), std::max(all.parameters, worst.parameters)};
    }
    MESSAGE("laws: inputs ", all.inputs, ", parameters ", all.parameters);
}

TEST_CASE("a slack cable has no effect, and its tension and its derivatives are zero") {
    Description d = plain();
    d.gravity_m_s2 = {0, 0, 9.81};
    d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 1.1}),
                flexor(d.mesh, {CableTarget::Kind::tension_N, 0.05})};
    d.cables[1].name = "other";
    d.markers = {{"tip", d.cables[0].points.back()}};
    Case c(std::move(d));
    const Worst worst = errors_of(c, c.system.rest(), [](Equilibrium& system) { return system.controls(1); });
    MESSAGE("slack: inputs ", worst.inputs, ", parameters ", worst.parameters);
}

TEST_CASE("derivatives for a cable with friction, with lagged tension shares") {
    Description d = plain();
    d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.95})};
    d.cables[0].friction = 0.4;
    d.markers = {{"tip", d.cables[0].points.back()}};
    Case c(std::move(d));
    State frozen = settled_from(c.system, c.system.controls(0.5), c.system.rest());
    const auto controls_of = [&](Equilibrium& system) {
        Controls controls = system.controls(0.5);
        std::vector<Drive> wanted = controls.drives;
        wanted[0].value = system.actuators()[0].measure(linalg::view(frozen.x));
        system.freeze_cable_friction(frozen.x, wanted, system.controls(0).drives, controls);
        return controls;
    };
    for (int round = 0; round < 30; ++round) frozen = settled_from(c.system, controls_of(c.system), frozen);
    const Worst worst = errors_of(c, frozen, controls_of);
    MESSAGE("cable with friction: inputs ", worst.inputs, ", parameters ", worst.parameters);
}

TEST_CASE("derivatives for a cable through gap elements") {
    Description d = plain();
    d.materials.push_back({"gap", gap_law(1e6), 0});
    d.materials.push_back({"wide gap", gap_law(1e6), 0});
    d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.99})};
    d.mesh.region_names = {"solid", "gap", "wide gap"};
    d.material_of_region = {0, 1, 2};
    for (std::size_t t = 0; t < 7; ++t) d.mesh.region[t + 20] = t < 4 ? 1 : 2;
    d.growths = {{1, {1, 0, 0}, 0, 1e5, edge, {1.5 * edge, 0.5 * edge, 0.9 * edge}},
                 {2, {0.8, 0.6, 0}, 0, 3e5, 0.5 * edge, {1.5 * edge, 0.5 * edge, 0.9 * edge}}};
    d.markers = {{"tip", d.cables[0].points.back()}};
    Case c(std::move(d));
    const Worst worst = errors_of(c, c.system.rest(), at_50_percent);
    MESSAGE("gap elements: inputs ", worst.inputs, ", parameters ", worst.parameters);
}

TEST_CASE("derivatives for contact with a moving obstacle and self-contact, with lagged friction") {
    Case c(touching_blocks());
    const Settled at = pressed(c.system);
    State start = at.state;
    Noise noise(6);
    for (double& entry : start.x) entry += 0.002 * edge * noise();
    const auto controls_of = [&](Equilibrium& system) {
        Controls controls = system.controls(0.9);
        controls.friction = system.freeze_friction(at.state, start, controls, system.controls(0.8));
        return controls;
    };
    const Worst worst = errors_of(c, at.state, controls_of);
    MESSAGE("contact: inputs ", worst.inputs, ", parameters ", worst.parameters);
}
