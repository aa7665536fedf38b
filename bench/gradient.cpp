// Prints the table of gradients in docs/performance.md: the time of a gradient by everything, and of the program that
// it belongs to, measured in the same run on one core. Every row is a process of its own.
//   build/release/bench/pliant_gradient [TETS [ROBOT]]      meshes of at most TETS tets (default 300000); only robots
//                                                           whose name contains ROBOT
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>

#include "problems.hpp"
#include "simulation/gradient/variation.hpp"
#include "simulation/run/simulate.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

/// Measures processor time, so that other users of the machine do not count.
class Stopwatch {
public:
    [[nodiscard]] double read_s() const { return now_s() - begin_s_; }

private:
    [[nodiscard]] static double now_s() {
        timespec t{};
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
        return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
    }
    double begin_s_ = now_s();
};

struct Times {
    double tangent_s = 0, adjoint_s = 0, numbers_s = 0, rest_s = 0;
    [[nodiscard]] double all() const { return tangent_s + adjoint_s + numbers_s + rest_s; }
};

/// Derivatives of the tip's z by all inputs, by all numbers of the robot, by the constants of each tet, and by all rest
/// positions.
Result<Times> gradient_times(const Stepper& stepper, const RobotState& robot) {
    Times times;
    Stopwatch watch;
    const auto lap = [&] {
        const double spent = watch.read_s();
        watch = Stopwatch();
        return spent;
    };
    auto at = Linearisation::create(stepper.system(), robot.now.state, robot.controls,
                                    known_pattern(stepper.system(), stepper.laplacian(), robot.memory.get()),
                                    gradient_residual);
    if (!at) return tl::unexpected(at.error());
    const Slope tip = slope(*at, {Measure::Kind::marker, 0, {0, 0, 1}});
    times.tangent_s = lap();
    const auto adjoint = at->adjoint(tip.state);
    if (!adjoint) return tl::unexpected(adjoint.error());
    times.adjoint_s = lap();
    const Variation numbers = gradient(*at, *adjoint, tip, {.tets = true});
    times.numbers_s = lap();
    const Variation rest = gradient(*at, *adjoint, tip, {.inputs = false, .parameters = false, .rest = true});
    times.rest_s = lap();
    return times;
}

double peak_MB() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// Prints the fastest of several runs of the program, and of the gradient at its end.
void row(const std::string& name, const Description& description, const Program& program) {
    const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
    const auto model = Model::create(description);
    const int repeats = model->mesh().tet_count() > 200000 ? 1 : 5;
    double forward_s = 1e300;
    Times best;
    for (int k = 0; k < repeats; ++k) {
        Progress silent;
        Stopwatch watch;
        Stepper stepper(*model, stepper_options(program));
        RobotState robot = stepper.rest();
        for (int step = 1; step <= program.steps; ++step) {
            if (!stepper.step(robot, program_path(stepper, program, robot, step), silent).arrived)
                return fmt::print("| {} | did not converge |\n", name);
        }
        forward_s = std::min(forward_s, watch.read_s());
        const auto times = gradient_times(stepper, robot);
        if (!times) return fmt::print("| {} | {} |\n", name, times.error().message);
        if (k == 0 || times->all() < best.all()) best = *times;
    }
    const double step_s = forward_s / program.steps;
    fmt::print(
        "| {} | {} | {} | {:.0f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} % | {:.0f} % | {:.0f} |\n", name,
        model->mesh().tet_count(), program.steps, 1e3 * forward_s, 1e3 * best.tangent_s, 1e3 * best.adjoint_s,
        1e3 * best.numbers_s, 1e3 * best.rest_s, 1e3 * best.all(), 100 * best.all() / forward_s,
        100 * best.all() / step_s, peak_MB());
}

void in_a_process(const std::string& name, const std::function<Description()>& describe, const Program& program) {
    std::fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        row(name, describe(), program);
        std::fflush(stdout);
        std::_Exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
}

}  // namespace

int main(int argc, char** argv) {
    const double most = argc > 1 ? std::atof(argv[1]) : 3e5;
    const std::string wanted = argc > 2 ? argv[2] : "";
    const auto apart = [&](const std::string& name, const std::function<Description()>& describe, const Program& how) {
        if (name.find(wanted) != std::string::npos) in_a_process(name, describe, how);
    };
    fmt::print(
        "Processor time on one core, the fastest of several runs.\n"
        "program: all its steps. tangent: its assembly. adjoint: the transposed solution with its factorisation.\n"
        "numbers: derivatives by inputs, by numbers of the robot and by the constants of each tet.\n"
        "gradient: tangent, adjoint, numbers and rest positions together.\n\n"
        "| robot | tets | steps | program, ms | tangent, ms | adjoint, ms | numbers, ms | rest positions, ms | "
        "gradient, ms | gradient / program | gradient / step | peak memory, MB |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    const Program program{.steps = 20, .tolerance = 1e-4};
    apart(
        "bend", [] { return bench::two_material_bend(0.45, 1); }, program);
    apart(
        "cable, 1 % each", [] { return bench::cable_bar(1); }, program);
    apart(
        "chamber", [] { return bench::air_bar(); }, program);
    if (const char* folder = std::getenv("PLIANT_REFERENCE_DATA"))
        apart("finger", [&] { return bench::finger_7k(folder); }, {.steps = 40, .tolerance = 1e-4});
    apart(
        "cable, 1 % each, quadratic", [] { return bench::cable_bar(2); }, program);
    const int sizes[][2] = {{48, 5}, {100, 10}, {160, 16}, {256, 26}};
    for (const auto& [along, across] : sizes) {
        if (6.0 * along * across * across > most) break;
        apart("bend, from rest", [&] { return bench::two_material_bend(0.45, 1, along, across); },
              {.steps = 1, .tolerance = 1e-4});
    }
}
