// Speed of the solver. A time means nothing without what was reached: every case reports iterations per frame and the
// tip or tension that it ended with, so that two runs can be held against each other at equal accuracy.
#include <benchmark/benchmark.h>

#include "problems.hpp"
#include "simulation/run/simulate.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

void report_on(benchmark::State& state, const Trajectory& result) {
    int iterations = 0;
    for (const Step& step : result.steps) iterations += step.iterations;
    const double frames = static_cast<double>(result.steps.size() - 1);
    state.counters["ms_per_frame"] = 1e3 * result.solve_s / frames;
    state.counters["setup_ms"] = 1e3 * result.setup_s;
    state.counters["iterations_per_frame"] = iterations / frames;
    state.counters["converged"] = result.converged ? 1 : 0;
    state.counters["tip_z_mm"] = 1e3 * result.steps.back().markers[0].position_m.z;
    if (!result.steps.back().cables.empty()) state.counters["tension_N"] = result.steps.back().cables[0].tension_N;
}

void run_case(benchmark::State& state, Description description, const Program& program) {
    const auto model = Model::create(std::move(description));
    Progress silent;
    Trajectory result;
    for (auto _ : state) {
        Program solver_alone = program;
        solver_alone.checks = false;
        result = run(*model, solver_alone, silent);
        benchmark::DoNotOptimize(result);
    }
    report_on(state, result);
}

void bend(benchmark::State& state, Solver solver, double tolerance) {
    run_case(state, bench::two_material_bend(0.45, 1), {.steps = 20, .tolerance = tolerance, .solver = solver});
}

void cable(benchmark::State& state, int order) {
    run_case(state, bench::cable_bar(order), {.steps = 20});
}

void chamber(benchmark::State& state) {
    run_case(state, bench::air_bar(), {.steps = 20});
}

}  // namespace

BENCHMARK_CAPTURE(bend, newton_1e3, Solver::newton, 1e-3)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bend, newton_1e6, Solver::newton, 1e-6)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bend, quasi_newton_1e3, Solver::quasi_newton, 1e-3)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bend, quasi_newton_1e6, Solver::quasi_newton, 1e-6)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bend, local_global_1e3, Solver::local_global, 1e-3)->Unit(benchmark::kMillisecond);
BENCHMARK(chamber)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(cable, linear, 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(cable, quadratic, 2)->Unit(benchmark::kMillisecond);
