// Time integration: order of accuracy, conservation of energy, and adaptive steps. PLIANT_SWINGS makes the swing over
// which energy is observed longer (default 50 periods).
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/core/near.hpp"
#include "simulation/run/test_beam.hpp"
#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;
using testing::beam;
using testing::beam_density;
using testing::beam_frequency_Hz;
using testing::beam_length;
using testing::beam_thickness;
using testing::solve;

namespace {

double tip_height(const Step& step) {
    return step.markers[0].position_m.z;
}

double energy(const Step& step) {
    return step.energy_J + step.kinetic_energy_J;
}

Program program(int steps, double duration, Dynamics dynamics) {
    return {.steps = steps, .duration = duration, .tolerance = 1e-8, .dynamics = dynamics};
}

/// Where the tip is after 0.2 s, with that many steps.
double end(int steps, const Dynamics& dynamics) {
    const Trajectory run = solve(beam(1, 6, 5), program(steps, 0.2, dynamics));
    REQUIRE_MESSAGE(run.converged, run.message);
    return tip_height(run.steps.back());
}

}  // namespace

TEST_CASE("the error of both integrators is quadratic in the time step") {
    for (const Integrator integrator : {Integrator::bdf2, Integrator::energy_conserving}) {
        CAPTURE(static_cast<int>(integrator));
        const Dynamics dynamics{{0, 2e-3}, integrator, 0};
        const double a = end(40, dynamics), b = end(80, dynamics), c = end(160, dynamics), d = end(320, dynamics);
        CHECK(std::log2(std::fabs((a - b) / (b - c))) == near(2, {.absolute = 0.2}));
        CHECK(std::log2(std::fabs((b - c) / (c - d))) == near(2, {.absolute = 0.1}));
    }
}

TEST_CASE("energy-conserving: over fifty periods a beam keeps its energy and its frequency") {
    const char* wanted = std::getenv("PLIANT_SWINGS");
    const int periods = wanted != nullptr ? std::atoi(wanted) : 50;
    const double period = 1 / beam_frequency_Hz();
    constexpr int per_period = 24;
    Description d = beam(2, 4, 1);
    const Program p{.steps = per_period * periods,
                    .duration = periods * period,
                    .tolerance = 1e-7,
                    .dynamics = Dynamics{{}, Integrator::energy_conserving, 0}};
    const Trajectory swing = solve(d, p);
    REQUIRE_MESSAGE(swing.converged, swing.message);
    const double rest = tip_height(solve(d, {.steps = 1, .tolerance = 1e-8}).steps.back());
    double largest_kinetic = 0, first = 0, last = 0;
    int crossings = 0;
    for (std::size_t k = 1; k < swing.steps.size(); ++k) {
        largest_kinetic = std::max(largest_kinetic, swing.steps[k].kinetic_energy_J);
        const double before = tip_height(swing.steps[k - 1]) - rest, now = tip_height(swing.steps[k]) - rest;
        if (!(before > 0 && now <= 0)) continue;
        last = swing.steps[k - 1].time + before / (before - now) * (swing.steps[k].time - swing.steps[k - 1].time);
        if (crossings++ == 0) first = last;
    }
    for (const Step& step : swing.steps) CHECK(std::fabs(energy(step)) < 2e-3 * largest_kinetic);
    REQUIRE(crossings > periods / 2);
    // 24 steps a period make it longer by (2 pi / 24)^2 / 12, 0.6 %.
    CHECK((last - first) / (crossings - 1) == near(period, {.relative = 0.03}));
    // BDF2 loses most of it in that time.
    Program lossy = p;
    lossy.dynamics = Dynamics{};
    lossy.steps = 10 * per_period;
    lossy.duration = 10 * period;
    const Trajectory damped = solve(d, lossy);
    CHECK(energy(damped.steps.back()) < -0.2 * largest_kinetic);
}

TEST_CASE("error-controlled steps keep the tolerance, reach the given instants, and are more when it is small") {
    const Description d = beam(1, 6, 30);
    const Trajectory fine = solve(d, program(800, 0.2, Dynamics{{}, Integrator::energy_conserving, 0}));
    int before = 0;
    for (const Integrator integrator : {Integrator::bdf2, Integrator::energy_conserving}) {
        before = 0;
        for (const double tolerance : {1e-4, 1e-5, 1e-6}) {
            const Trajectory run = solve(d, program(10, 0.2, Dynamics{{}, integrator, tolerance}));
            REQUIRE_MESSAGE(run.converged, run.message);
            REQUIRE(run.steps.size() == 11);
            int pieces = 0;
            double off = 0;
            for (std::size_t k = 0; k < run.steps.size(); ++k) {
                CHECK(run.steps[k].time == near(0.02 * static_cast<double>(k), {.absolute = 1e-12}));
                off = std::max(off, std::fabs(tip_height(run.steps[k]) - tip_height(fine.steps[80 * k])));
                if (k > 0) pieces += run.steps[k].substeps;
            }
            MESSAGE("tolerance ", tolerance, " m: ", pieces, " steps, off by ", off, " m");
            CHECK(off < pieces * tolerance);  // the errors of all steps add up
            CHECK(pieces > before);
            before = pieces;
        }
    }
}

TEST_CASE("a step with too large an error is repeated smaller, and the run counts it") {
    // Nothing happens until a force comes at once: the step that had grown is too long for it.
    Description d = beam(1, 6, 0);
    const auto end = reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > beam_length - 1e-9; });
    d.loads = {{"push",
                end,
                std::vector<double>(end.size(), 1.0 / static_cast<double>(end.size())),
                {0, 0, 0.02},
                Curve{{0, 0.1, 0.1001}, {0, 0, 1}}}};
    const Trajectory run = solve(d, program(4, 0.2, Dynamics{{}, Integrator::energy_conserving, 1e-6}));
    REQUIRE_MESSAGE(run.converged, run.message);
    CHECK(run.steps[2].refused == 0);
    CHECK(run.steps[3].refused > 0);
    CHECK(run.steps[3].substeps > 4 * run.steps[2].substeps);
    // An impossible tolerance ends the run, with a message.
    const Trajectory stuck = solve(d, program(4, 0.2, Dynamics{{}, Integrator::bdf2, 1e-30}));
    CHECK_FALSE(stuck.converged);
    CAPTURE(stuck.message);
    CHECK(stuck.message.find("more than time_tolerance") != std::string::npos);
}

TEST_CASE("a moving support does not excite vibration in the body it holds") {
    Description d = beam(1, 6, 0);
    d.supports[0].move_m = {0, 0.02, 0};
    d.supports[0].share = Curve{{0, 0.2}, {0, 1}};
    const Trajectory run = solve(d, program(100, 0.2, Dynamics{{5, 1e-3}, Integrator::energy_conserving, 0}));
    REQUIRE_MESSAGE(run.converged, run.message);
    // Damping ends the vibration that its start has made. The clamp has the speed of its motion; what it takes to hold
    // it does not turn about from step to step.
    const double mass = beam_density * beam_length * beam_thickness * beam_thickness;
    for (std::size_t k = 20; k < run.steps.size(); ++k) {
        const double now = run.steps[k].supports[0].force_N.y, before = run.steps[k - 1].supports[0].force_N.y;
        CHECK(std::fabs(now - before) < 0.5 * mass * 0.1 / 0.02);
    }
}
