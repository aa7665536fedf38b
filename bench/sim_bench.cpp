// Speed of the solver. A time means nothing without what was reached: every case reports iterations per frame and the
// tip or tension that it ended with, so that two runs can be held against each other at equal accuracy.
#include <benchmark/benchmark.h>

#include "sim/loads.hpp"
#include "sim/reference_problems.hpp"
#include "sim/simulate.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

/// Box 100 x 10 x 10 mm in 48 x 5 x 5 cells (7,200 linear tets), 45 and 12 MPa, bent by 5 N at its end.
Description two_material_bend(double nu, int order) {
    Description d;
    d.mesh = reference::kuhn_box({0.1, 0.01, 0.01}, 48, 5, 5, [](Vec3 c) { return c.x < 0.05 ? 0 : 1; });
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"hard", material::neo_hookean(45e6, nu), 0}, {"soft", material::neo_hookean(12e6, nu), 0}};
    d.material_of_region = {0, 1};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    std::vector<mesh::Face> faces;
    for (const mesh::Face& f : mesh::boundary_faces(d.mesh)) {
        const auto& p = d.mesh.points;
        if (p[f.nodes[0]].x + p[f.nodes[1]].x + p[f.nodes[2]].x > 0.3 - 1e-9) faces.push_back(f);
    }
    const SurfaceShares shares = surface_shares(d.mesh, faces);
    d.loads = {{"tip", shares.nodes, shares.shares, {0, 0, 5}}};
    d.markers = {{"tip", reference::mean_of(reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 0.1 - 1e-9; }))}};
    return d;
}

/// A bar of 100 x 10 x 10 mm with a cable along its upper side.
Description cable_bar(int order) {
    Description d = two_material_bend(0.45, order);
    d.loads.clear();
    Cable cable{"flexor", {}, {CableTarget::Kind::length_ratio, 0.8}};
    for (int k = 0; k <= 8; ++k) {
        const Vec3 at{0.0125 * k, 0.004, 0.01};
        const auto nodes = reference::nodes_where(d.mesh, [&](Vec3 p) { return norm(p - at) < 1e-9; });
        if (!nodes.empty()) cable.points.push_back({nodes, {1.0}, {}});
    }
    d.cables = {cable};
    return d;
}

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
        result = run(*model, program, silent);
        benchmark::DoNotOptimize(result);
    }
    report_on(state, result);
}

void bend(benchmark::State& state, Solver solver, double tolerance) {
    run_case(state, two_material_bend(0.45, 1), {.steps = 20, .tolerance = tolerance, .solver = solver});
}

void cable(benchmark::State& state, int order) {
    run_case(state, cable_bar(order), {.steps = 20});
}

}  // namespace

BENCHMARK_CAPTURE(bend, newton_1e3, Solver::newton, 1e-3)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bend, newton_1e6, Solver::newton, 1e-6)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bend, quasi_newton_1e3, Solver::quasi_newton, 1e-3)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bend, quasi_newton_1e6, Solver::quasi_newton, 1e-6)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bend, local_global_1e3, Solver::local_global, 1e-3)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(cable, linear, 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(cable, quadratic, 2)->Unit(benchmark::kMillisecond);
