// Small robots for the tests, and targets that a forward solution shows to be reachable.
#pragma once

#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

#include "simulation/actuators/attach.hpp"
#include "simulation/inverse/follow.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/run/test_problems.hpp"

namespace pliant::sim::inverse::testing {

inline constexpr double length = 0.06, width = 0.01;

inline mesh::TetMesh bar_mesh(int order) {
    mesh::TetMesh mesh = reference::kuhn_box({length, width, width}, 12, 2, 2, [](Vec3) { return 0; });
    mesh.region_names = {"bar"};
    return order == 2 ? mesh::to_quadratic(mesh) : mesh;
}

/// A cable along the bar at this height and depth, with a guide at every quarter of its length.
inline Cable cable_at(const mesh::TetMesh& mesh, const std::string& name, double y, double z,
                      const CableTarget& target) {
    Cable cable{name, {}, target};
    const Attacher attacher(mesh);
    for (int k = 0; k <= 4; ++k) cable.points.push_back(*attacher.carried_by_tet({length * k / 4, y, z}, 1e-6));
    return cable;
}

/// A bar of 60 x 10 x 10 mm, clamped at x = 0, with the first `cables` of four cables along its edges: above, below,
/// left, right.
inline Description bar(int cables, int order = 1, CableTarget::Kind kind = CableTarget::Kind::length_ratio) {
    Description d;
    d.mesh = bar_mesh(order);
    d.materials = {{"A", material::neo_hookean(1e6, 0.45), 1000}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    const CableTarget rest{kind, kind == CableTarget::Kind::length_ratio ? 1.0 : 0.0};
    constexpr double near = 0.1 * width, middle = 0.5 * width, far = 0.9 * width;
    const std::vector<std::pair<double, double>> places = {
        {middle, far}, {middle, near}, {near, middle}, {far, middle}};
    const std::vector<std::string> names = {"above", "below", "left", "right"};
    for (std::size_t k = 0; k < static_cast<std::size_t>(cables); ++k)
        d.cables.push_back(cable_at(d.mesh, names[k], places[k].first, places[k].second, rest));
    d.markers = {
        {"tip", reference::mean_of(reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > length - 1e-9; }))}};
    return d;
}

/// A hollow block with a controllable air volume, and a cable that bends it.
inline Description hollow(int order, const ChamberTarget& target) {
    Description d = sim::testing::hollow_block(order);
    d.chambers[0].target = target;
    Cable cable{"flexor", {}, {CableTarget::Kind::length_ratio, 1}};
    const Attacher attacher(d.mesh);
    for (const double x : {0.0, 0.01, 0.02, 0.03})
        cable.points.push_back(*attacher.carried_by_tet({x, 0.005, 0.0095}, 1e-6));
    d.cables = {cable};
    return d;
}

inline Model made(Description d) {
    auto model = Model::create(std::move(d));
    REQUIRE_MESSAGE(model, (model ? "" : model.error().message));
    return std::move(*model);
}

inline const StepperOptions tight{.tolerance = 1e-6, .time_unit = 0.1};

/// All cables and chambers of the model, with these ranges.
inline InverseTask task_for(const Model& model, const std::vector<std::pair<double, double>>& ranges) {
    InverseTask task;
    const Description& d = model.description();
    for (std::size_t a = 0; a < ranges.size(); ++a) {
        const bool cable = a < d.cables.size();
        const bool ratio = cable ? d.cables[a].target.kind == CableTarget::Kind::length_ratio
                                 : d.chambers[a - d.cables.size()].target.kind == ChamberTarget::Kind::volume_ratio;
        const std::string& name = cable ? d.cables[a].name : d.chambers[a - d.cables.size()].name;
        task.inputs.push_back({a, name, ranges[a].first, ranges[a].second, ratio ? 1.0 : 0.0, {}, 0, 0});
    }
    task.times = {1};
    return task;
}

inline Goal at_point(const Vec3& point, double tolerance = 1e-4) {
    Goal goal;
    goal.name = "reach";
    goal.markers = {0};
    goal.wanted = {{point}};
    goal.tolerance = tolerance;
    return goal;
}

/// Position of the first marker under these inputs (in the units of the targets).
inline Vec3 tip_under(const Model& model, const InverseTask& task, const std::vector<double>& values) {
    Stepper stepper(model, tight);
    const InputSpace space(stepper, task);
    Eigen::VectorXd shares(space.size());
    for (Eigen::Index i = 0; i < shares.size(); ++i) shares[i] = space.share(i, values[static_cast<std::size_t>(i)]);
    RobotState robot = stepper.rest();
    const StepReport report = stepper.drive(robot, space.inputs(shares, 1), {});
    REQUIRE_MESSAGE(report.arrived, report.reason);
    const auto& x = robot.x();
    return position(model.description().markers[0].point, {x.data(), static_cast<std::size_t>(x.size())});
}

inline InverseResult solve(const Model& model, const InverseTask& task, const FollowOptions& options = {}) {
    Stepper stepper(model, tight);
    Progress silent;
    return follow(stepper, task, options, silent);
}

}  // namespace pliant::sim::inverse::testing
