// Inverse kinematics on five robots: all targets that known inputs reach must be found; for targets out of reach the
// nearest place must be found, compared with dense sampling.
//   build/release/bench/pliant_inverse_battery [INSIDE [OUTSIDE]]      numbers of targets within and out of reach, for
//   all
//                                                                      robots together (1000 and 200)
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/core/stopwatch.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/inverse/follow.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/simulate.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::inverse;

namespace {

constexpr double length = 0.06, width = 0.01;
constexpr double tolerance_m = 1e-4;
const StepperOptions stepping{.tolerance = 1e-5, .time_unit = 0.1};

struct Robot {
    std::string name;
    Description description;
    std::vector<std::pair<double, double>> ranges;
};

Description bar(int cables, int order, CableTarget::Kind kind) {
    Description d;
    d.mesh = reference::kuhn_box({length, width, width}, 12, 2, 2, [](Vec3) { return 0; });
    d.mesh.region_names = {"bar"};
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"A", material::neo_hookean(1e6, 0.45), 1000}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    const Attacher attacher(d.mesh);
    const std::array<std::pair<double, double>, 4> places = {{{0.5, 0.9}, {0.5, 0.1}, {0.1, 0.5}, {0.9, 0.5}}};
    for (std::size_t c = 0; c < static_cast<std::size_t>(cables); ++c) {
        Cable cable{fmt::format("cable {}", c + 1), {}, {kind, kind == CableTarget::Kind::length_ratio ? 1.0 : 0.0}};
        for (int k = 0; k <= 4; ++k)
            cable.points.push_back(
                *attacher.carried_by_tet({length * k / 4, width * places[c].first, width * places[c].second}, 1e-6));
        d.cables.push_back(std::move(cable));
    }
    d.markers = {
        {"tip", reference::mean_of(reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > length - 1e-9; }))}};
    return d;
}

/// A bar with a channel of air under a cable.
Description hollow() {
    const auto void_at = [](Vec3 c) {
        return c.x > 0.005 && c.x < 0.055 && c.y > 0.0025 && c.y < 0.0075 && c.z > 0.0025 && c.z < 0.005 ? 1 : 0;
    };
    mesh::TetMesh whole = reference::kuhn_box({length, width, width}, 12, 4, 4, void_at);
    whole.region_names = {"solid", "air"};
    mesh::Extract solid = mesh::extract_regions(whole, {true, false});
    Description d;
    d.mesh = std::move(solid.mesh);
    d.materials = {{"A", material::neo_hookean(5e5, 0.4), 1000}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    d.chambers.push_back({"air", wall_of_faces(whole, mesh::region_faces(whole, 1), solid.node), {}});
    d.chambers[0].target = {ChamberTarget::Kind::volume_ratio, 1};
    Cable cable{"side", {}, {CableTarget::Kind::length_ratio, 1}};
    const Attacher attacher(d.mesh);
    for (int k = 0; k <= 4; ++k)
        cable.points.push_back(*attacher.carried_by_tet({length * k / 4, 0.05 * width, 0.55 * width}, 1e-6));
    d.cables = {cable};
    d.markers = {
        {"tip", reference::mean_of(reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > length - 1e-9; }))}};
    return d;
}

std::vector<Robot> robots() {
    using Kind = CableTarget::Kind;
    const std::pair<double, double> ratio{0.75, 1}, tension{0, 8};
    std::vector<Robot> list;
    list.push_back({"2 lengths", bar(2, 1, Kind::length_ratio), {ratio, ratio}});
    list.push_back({"4 lengths", bar(4, 1, Kind::length_ratio), {ratio, ratio, ratio, ratio}});
    list.push_back({"3 tensions", bar(3, 1, Kind::tension_N), {tension, tension, tension}});
    list.push_back({"length and volume", hollow(), {{0.8, 1}, {0.9, 1.6}}});
    list.push_back({"3 lengths, quadratic", bar(3, 2, Kind::length_ratio), {ratio, ratio, ratio}});
    return list;
}

InverseTask task_of(const Robot& robot, const Model& model) {
    InverseTask task;
    const Description& d = model.description();
    for (std::size_t a = 0; a < robot.ranges.size(); ++a) {
        const bool cable = a < d.cables.size();
        const bool ratio = !cable || d.cables[a].target.kind == CableTarget::Kind::length_ratio;
        task.inputs.push_back({a,
                               cable ? d.cables[a].name : d.chambers[a - d.cables.size()].name,
                               robot.ranges[a].first,
                               robot.ranges[a].second,
                               ratio ? 1.0 : 0.0,
                               {},
                               0,
                               0});
    }
    Goal goal;
    goal.name = "reach";
    goal.markers = {0};
    goal.tolerance = tolerance_m;
    task.goals = {goal};
    task.times = {1};
    return task;
}

/// Of the first marker, on a straight way from rest; nothing where that leads to no equilibrium.
std::optional<Vec3> tip_under(Stepper& stepper, const InputSpace& space, const Eigen::VectorXd& shares) {
    RobotState robot = stepper.rest();
    if (!stepper.drive(robot, space.inputs(shares, 1), {}).arrived) return std::nullopt;
    const std::span<const double> x(robot.x().data(), static_cast<std::size_t>(robot.x().size()));
    return position(stepper.model().description().markers[0].point, x);
}

struct Tally {
    int asked = 0, right = 0, forward = 0;
    double wall_s = 0;
};

void add(const InverseResult& result, Tally& tally) {
    ++tally.asked;
    tally.forward += result.waypoints.at(0).work.forward;
    tally.wall_s += result.waypoints.at(0).wall_s;
}

Tally inside(const Model& model, InverseTask task, int count) {
    Tally tally;
    Stepper stepper(model, stepping);
    const InputSpace space(stepper, task);
    Progress silent;
    for (int n = 0; n < count; ++n) {
        const Eigen::VectorXd shares = spread_point(n + 20, space.size());
        const std::optional<Vec3> wanted = tip_under(stepper, space, shares);
        if (!wanted) continue;
        task.goals[0].wanted = {{*wanted}};
        const InverseResult result = follow(stepper, task, {}, silent);
        add(result, tally);
        if (result.reached)
            ++tally.right;
        else
            fmt::print("  reachable target {}: not reached, {:.3f} mm away\n", n,
                       1e3 * result.waypoints[0].goals[0].error);
    }
    return tally;
}

/// Targets out of reach. A result is right if no sample comes nearer to the target by more than the tolerance.
Tally outside(const Model& model, InverseTask task, int count) {
    Tally tally;
    Stepper stepper(model, stepping);
    const InputSpace space(stepper, task);
    Progress silent;
    std::vector<Vec3> samples;
    constexpr int sample_count = 1500;
    for (int n = 0; n < sample_count; ++n) {
        // Values beyond the ranges, a third of them, are moved to the ends of the ranges.
        const Eigen::VectorXd shares = (1.5 * (spread_point(n + 1, space.size()).array() - 0.5) + 0.5).max(0).min(1);
        if (const auto tip = tip_under(stepper, space, shares)) samples.push_back(*tip);
    }
    for (int n = 0; tally.asked < count && n < 10 * count; ++n) {
        const Eigen::VectorXd way = spread_point(7 * n + 3, 3);
        const Vec3& base = samples[static_cast<std::size_t>(37 * n + 11) % samples.size()];
        const Vec3 wanted = base + 0.05 * Vec3{way[0] - 0.2, way[1] - 0.5, way[2] - 0.5};
        double nearest = 1e300;
        for (const Vec3& sample : samples) nearest = std::min(nearest, norm(sample - wanted));
        if (nearest < 3e-3) continue;  // the target may be within reach
        task.goals[0].wanted = {{wanted}};
        const InverseResult result = follow(stepper, task, {}, silent);
        if (result.reached) continue;  // it was within reach, between the samples
        add(result, tally);
        const double error = result.waypoints.at(0).goals[0].error;
        if (error <= nearest + tolerance_m)
            ++tally.right;
        else
            fmt::print("  unreachable target {}: result {:.3f} mm away, nearest sample {:.3f} mm\n", n, 1e3 * error,
                       1e3 * nearest);
    }
    return tally;
}

void print(const std::string& name, const char* where, const Tally& t) {
    const double count = std::max(1, t.asked);
    fmt::print("| {} | {} | {} of {} | {:.1f} | {:.1f} |\n", name, where, t.right, t.asked, t.forward / count,
               1e3 * t.wall_s / count);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    const int inside_count = argc > 1 ? std::atoi(argv[1]) : 1000, outside_count = argc > 2 ? std::atoi(argv[2]) : 200;
    fmt::print("| robot | targets | right | equilibria per target | time per target, ms |\n|---|---|---|---|---|\n");
    const std::vector<Robot> all = robots();
    int wrong = 0;
    for (const Robot& robot : all) {
        const auto model = Model::create(robot.description);
        if (!model) {
            fmt::print("{}: {}\n", robot.name, model.error().message);
            return 1;
        }
        const InverseTask task = task_of(robot, *model);
        const Tally in = inside(*model, task, inside_count / static_cast<int>(all.size()));
        print(robot.name, "within reach", in);
        const Tally out = outside(*model, task, outside_count / static_cast<int>(all.size()));
        print(robot.name, "out of reach", out);
        wrong += in.asked - in.right + out.asked - out.right;
    }
    return wrong == 0 ? 0 : 1;
}
