// Prints the table of reduced models in docs/performance.md: frames a second beside those of the whole robot, on one
// core in the same run, and the error at every frame.
//   build/release/bench/pliant_reduced [ROBOT]      only robots whose name contains ROBOT
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <numbers>
#include <string>

#include "problems.hpp"
#include "simulation/inverse/input_space.hpp"
#include "simulation/reduced/error_estimate.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::reduced;

namespace {

constexpr int frames = 100;  ///< there and back through the ranges: 2 % of a range each on average
constexpr double tolerance = 1e-4;

/// Processor time, so that other users of the machine do not count.
double now_s() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double seconds_of(const std::function<void()>& work) {
    const double begin = now_s();
    work();
    return now_s() - begin;
}

/// Every actuator from no actuation to its target of the benchmark.
InverseTask task_of(const Description& d) {
    InverseTask task;
    for (std::size_t a = 0; a < d.cables.size() + d.chambers.size(); ++a) {
        const bool cable = a < d.cables.size();
        const double value = cable ? d.cables[a].target.value : d.chambers[a - d.cables.size()].target.value;
        const bool ratio = cable ? d.cables[a].target.kind == CableTarget::Kind::length_ratio
                                 : d.chambers[a - d.cables.size()].target.kind == ChamberTarget::Kind::volume_ratio;
        const double rest = ratio ? 1 : 0;
        task.inputs.push_back({a, "", std::min(rest, value), std::max(rest, value), rest, {}, 0, 0});
    }
    task.times = {1};
    return task;
}

void row(const std::string& name, const Description& description) {
    const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
    const auto model = Model::create(description);
    const InverseTask task = task_of(description);
    Progress silent;
    Result<Reduction> reduction = failure("");
    const double training_s =
        seconds_of([&] { reduction = reduce(*model, {.tolerance = tolerance, .most_past = 1}, task, {}, silent); });
    if (!reduction) return fmt::print("| {} | {} |\n", name, reduction.error().message);
    const auto reduced = ReducedModel::create(*model, *reduction);
    Stepper stepper(*model, {.tolerance = tolerance});
    const inverse::InputSpace space(stepper, task);
    ReducedSolver solver(*reduced);
    ErrorEstimator estimator(*reduced, stepper);
    const auto inputs_at = [&](int frame) {
        const double along = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * frame / frames);
        const Eigen::VectorXd rest = space.rest();
        return space.inputs(rest + along * (Eigen::VectorXd::Ones(space.size()) - 2 * rest), 1);
    };
    ReducedState state = solver.start(inputs_at(0));
    RobotState whole = stepper.rest();
    (void)solver.solve(state, inputs_at(0));
    (void)stepper.drive(whole, inputs_at(0), silent);
    double reduced_s = 0, estimate_s = 0, whole_s = 0, motion_m = 0, error_m = 0, estimated_m = 0;
    int iterations = 0;
    const Eigen::VectorXd rest = stepper.system().rest().x;
    for (int frame = 1; frame <= frames; ++frame) {
        const Inputs inputs = inputs_at(frame);
        bool found = false;
        reduced_s += seconds_of([&] {
            const ReducedReport report = solver.solve(state, inputs);
            found = report.found;
            iterations += report.iterations;
        });
        estimate_s += seconds_of([&] { estimated_m = std::max(estimated_m, estimator.estimate(state).error_m); });
        whole_s += seconds_of([&] { found = stepper.drive(whole, inputs, silent).arrived && found; });
        if (!found) return fmt::print("| {} | frame {} did not converge |\n", name, frame);
        motion_m = std::max(motion_m, longest(whole.x() - rest));
        error_m = std::max(error_m, longest(reduced->positions(state.at.amplitudes) - whole.x()));
    }
    const double each = 1e3 / frames;
    fmt::print(
        "| {} | {} | {} | {} | {:.1f} | {:.2f} | {:.0f} | {:.1f} | {:.2f} | {:.1f} | {:.0f} | {:.1f} | {:.3f} | {:.3f} "
        "|\n",
        name, model->mesh().tet_count(), reduced->mode_count(), reduction->tets.size(), training_s, each * reduced_s,
        frames / reduced_s, static_cast<double>(iterations) / frames, each * estimate_s, each * whole_s,
        whole_s / reduced_s, 1e3 * motion_m, 1e3 * error_m, 1e3 * estimated_m);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    const std::string wanted = argc > 1 ? argv[1] : "";
    fmt::print(
        "Processor time on one core. {} frames through the ranges and back, to a residual of {:g} of the whole "
        "robot.\n\n"
        "| robot | tets | modes | weighted tets | training, s | frame, ms | frames per second | iterations per frame | "
        "estimate, ms | whole robot, ms | ratio | largest motion, mm | largest error, mm | estimated, mm |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
        frames, tolerance);
    const auto ask = [&](const std::string& name, const std::function<Description()>& describe) {
        if (name.find(wanted) != std::string::npos) row(name, describe());
    };
    if (const char* folder = std::getenv("PLIANT_REFERENCE_DATA")) {
        ask("finger", [&] { return bench::finger_7k(folder); });
        ask("finger, quadratic", [&] {
            Description d = bench::finger_7k(folder);
            d.mesh = mesh::to_quadratic(d.mesh);
            return d;
        });
    }
    ask("cable bar", [] { return bench::cable_bar(1); });
    ask("cable bar, quadratic", [] { return bench::cable_bar(2); });
    ask("chamber", [] { return bench::air_bar(1); });
    ask("chamber, quadratic", [] { return bench::air_bar(2); });
}
