// Inverse kinematics on one core: processor time of the first waypoint, from rest, and of the later ones, each from the
// waypoint before; the equilibria that they need; and the time of a gradient by central differences.
//   build/release/bench/pliant_inverse_bench [small|large|all]
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <string>
#include <vector>

#include "problems.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/inverse/follow.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/simulate.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::inverse;

namespace {

constexpr double length = 0.1, side = 0.01;
constexpr std::size_t waypoints = 20;
constexpr double tolerance_m = 1e-4;

/// Processor time, so that other users of the machine do not count.
double now_ms() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

/// Records the time at which each waypoint begins.
class Beginnings final : public Progress {
public:
    void advance(std::string_view, double) override { ms_.push_back(now_ms()); }
    [[nodiscard]] double of(std::size_t waypoint) const { return ms_[waypoint + 1] - ms_[waypoint]; }

private:
    std::vector<double> ms_;
};

/// The bar of two materials with cables along its edges, every second pair over half its length.
Description cabled(int cables, int order, int along, int across) {
    Description d = bench::two_material_bend(0.45, order, along, across);
    d.loads.clear();
    const Attacher attacher(d.mesh);
    const std::array<std::array<double, 2>, 4> places = {{{0.5, 0.95}, {0.95, 0.5}, {0.5, 0.05}, {0.05, 0.5}}};
    for (int k = 0; k < cables; ++k) {
        const auto& place = places[static_cast<std::size_t>(k % 4)];
        Cable cable{fmt::format("cable {}", k + 1), {}, {CableTarget::Kind::length_ratio, 1}};
        const double end = k < 4 ? length : 0.5 * length;
        for (int p = 0; p <= 8; ++p)
            cable.points.push_back(*attacher.carried_by_tet({end * p / 8, side * place[0], side * place[1]}, 1e-6));
        d.cables.push_back(std::move(cable));
    }
    return d;
}

InverseTask task_of(const Model& model) {
    InverseTask task;
    for (std::size_t c = 0; c < model.description().cables.size(); ++c)
        task.inputs.push_back({c, model.description().cables[c].name, 0.7, 1, 1, {}, 0, 0});
    Goal goal;
    goal.name = "reach";
    goal.markers = {0};
    goal.tolerance = tolerance_m;
    task.goals = {goal};
    task.times.assign(waypoints, 1);
    return task;
}

/// The inputs of waypoint k on a reachable path: sines with a phase for each input.
Eigen::VectorXd path_inputs(std::size_t k, Eigen::Index size) {
    Eigen::VectorXd shares(size);
    for (Eigen::Index i = 0; i < size; ++i) {
        const double phase = 0.25 * static_cast<double>(k) - 1.5 * static_cast<double>(i);
        shares[i] = 1 - 0.35 * std::max(0.0, 0.6 + 0.4 * std::sin(phase)) / std::sqrt(static_cast<double>(size));
    }
    return shares;
}

struct Path {
    std::vector<std::vector<Vec3>> places;
    double forward_ms = 0;  ///< mean time of a step from one waypoint to the next with known inputs
};

Path forward_path(const Model& model, const InverseTask& task, const StepperOptions& options) {
    Stepper stepper(model, options);
    const InputSpace space(stepper, task);
    RobotState robot = stepper.rest();
    Path path;
    for (std::size_t k = 0; k < waypoints; ++k) {
        const double begin = now_ms();
        const StepReport report = stepper.drive(robot, space.inputs(path_inputs(k, space.size()), 1), {});
        if (!report.arrived) fmt::print("  no equilibrium at waypoint {}: {}\n", k + 1, report.reason);
        if (k > 0) path.forward_ms += (now_ms() - begin) / (waypoints - 1);
        const std::span<const double> x(robot.x().data(), static_cast<std::size_t>(robot.x().size()));
        path.places.push_back({position(model.description().markers[0].point, x)});
    }
    return path;
}

/// Time of a gradient by central differences: two equilibria for each input.
double central_ms(const Model& model, const InverseTask& task, const StepperOptions& options) {
    Stepper stepper(model, options);
    const InputSpace space(stepper, task);
    RobotState robot = stepper.rest();
    const Eigen::VectorXd at = path_inputs(5, space.size());
    (void)stepper.drive(robot, space.inputs(at, 1), {});
    const double begin = now_ms();
    for (Eigen::Index i = 0; i < space.size(); ++i) {
        for (const double step : {0.01, -0.01}) {
            RobotState trial = robot;
            Eigen::VectorXd shares = at;
            shares[i] += step;
            (void)stepper.drive(trial, space.inputs(shares, 1), {});
        }
    }
    return now_ms() - begin;
}

void row(const std::string& name, Description d) {
    const auto model = Model::create(std::move(d));
    if (!model) {
        fmt::print("{}: {}\n", name, model.error().message);
        return;
    }
    const StepperOptions options{.tolerance = 1e-4, .time_unit = 0.1};
    InverseTask task = task_of(*model);
    const Path path = forward_path(*model, task, options);
    task.goals[0].wanted = path.places;
    Beginnings beginnings;
    const double begin = now_ms();
    Stepper stepper(*model, options);
    const double setup_ms = now_ms() - begin;
    const InverseResult result = follow(stepper, task, {}, beginnings);
    std::vector<double> warm;
    Work work;
    double error = 0;
    std::size_t reached = 0;
    for (std::size_t k = 0; k < result.waypoints.size(); ++k) {
        const Waypoint& at = result.waypoints[k];
        reached += at.reached ? 1 : 0;
        error = std::max(error, at.goals[0].error);
        if (k == 0) continue;
        warm.push_back(beginnings.of(k));
        work.forward += at.work.forward;
        work.linearised += at.work.linearised;
        work.solutions += at.work.solutions;
    }
    double mean = 0;
    for (const double ms : warm) mean += ms / static_cast<double>(warm.size());
    std::nth_element(warm.begin(), warm.begin() + static_cast<std::ptrdiff_t>(warm.size() / 2), warm.end());
    const double count = static_cast<double>(waypoints - 1);
    fmt::print(
        "| {} | {} | {:.0f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.0f} | {}/{} | {:.3f} "
        "|\n",
        name, model->mesh().tet_count(), setup_ms + beginnings.of(0), mean, warm[warm.size() / 2], path.forward_ms,
        mean / path.forward_ms, work.forward / count, work.linearised / count, work.solutions / count,
        central_ms(*model, task, options), reached, waypoints, 1e3 * error);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
    const std::string what = argc > 1 ? argv[1] : "small";
    fmt::print(
        "A marker follows 20 waypoints within 0.1 mm. Processor time on one core.\n"
        "first: the first waypoint, from rest, with setup. later: mean of the others. step: a step from one waypoint "
        "to "
        "the next with known inputs. ratio: later / step.\n"
        "equilibria, linearisations, linear solutions: mean numbers for a later waypoint. differences: a gradient by "
        "central differences.\n\n"
        "| robot | tets | first, ms | later, ms | median, ms | step, ms | ratio | equilibria | linearisations | "
        "linear solutions | differences, ms | reached | largest error, mm |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    if (what != "large") {
        for (const int cables : {1, 2, 3, 4, 8})
            row(fmt::format("linear, {} cables", cables), cabled(cables, 1, 48, 5));
        row("linear, default size, 3 cables", cabled(3, 1, 24, 3));
        row("quadratic, default size, 3 cables", cabled(3, 2, 24, 3));
    }
    if (what != "small") row("linear, 3 cables", cabled(3, 1, 126, 14));
    return 0;
}
