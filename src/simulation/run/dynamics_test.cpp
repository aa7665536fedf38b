// Motion in time: a known frequency, energy that does not grow, damping that dissipates it.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "base/core/near.hpp"
#include "simulation/elements/elements.hpp"
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

TEST_CASE("the mass matrix gives a moving body its momentum and kinetic energy") {
    for (const int order : {1, 2}) {
        const Description d = beam(order, 10, 0);
        const auto elements = Elements::create(d);
        REQUIRE(elements);
        std::vector<double> u;
        for (std::size_t i = 0; i < d.mesh.points.size(); ++i) u.insert(u.end(), {1, 0, 2});
        std::vector<double> momentum(u.size(), 0.0);
        elements->apply_mass(u, momentum);
        double x = 0;
        double energy = 0;
        for (std::size_t i = 0; i < u.size(); ++i) {
            if (i % 3 == 0) x += momentum[i];
            energy += 0.5 * u[i] * momentum[i];
        }
        const double mass = beam_density * beam_length * beam_thickness * beam_thickness;
        CHECK(x == near(mass, {.relative = 1e-12}));
        CHECK(energy == near(0.5 * mass * 5, {.relative = 1e-12}));
    }
}

TEST_CASE("a beam released under gravity swings at its natural frequency and gains no energy") {
    const double period = 1 / beam_frequency_Hz();
    const Description d = beam(2, 10, 0.5);  // little gravity: small motion
    const int steps = 120;
    const Trajectory swing =
        solve(d, {.steps = steps, .duration = 2 * period, .tolerance = 1e-6, .dynamics = Dynamics{}});
    REQUIRE_MESSAGE(swing.converged, swing.message);
    const Trajectory still = solve(d, {.steps = 1, .tolerance = 1e-8});
    const double rest = still.steps.back().markers[0].position_m.z;
    // The tip passes its rest position after a quarter and three quarters of a period.
    std::vector<double> crossings;
    double lowest = 0;
    for (std::size_t k = 1; k < swing.steps.size(); ++k) {
        const double before = swing.steps[k - 1].markers[0].position_m.z - rest;
        const double now = swing.steps[k].markers[0].position_m.z - rest;
        lowest = std::min(lowest, now);
        if (before * now < 0) {
            const double share = before / (before - now);
            crossings.push_back(swing.steps[k - 1].time + share * (swing.steps[k].time - swing.steps[k - 1].time));
        }
    }
    REQUIRE(crossings.size() >= 3);
    CHECK(crossings[2] - crossings[0] == near(period, {.relative = 0.03}));
    CHECK(lowest == near(-(beam_thickness / 2 - rest), {.relative = 0.1}));  // as far below as it began above

    double energy = 0;  // undeformed, at rest
    for (std::size_t k = 1; k < swing.steps.size(); ++k) {
        const double now = swing.steps[k].energy_J + swing.steps[k].kinetic_energy_J;
        CHECK(now <= energy + 1e-4 * std::fabs(still.steps.back().energy_J));
        energy = now;
    }
    // Little is lost either: the integrator damps a period of 60 steps by a few percent.
    CHECK(energy > 0.15 * still.steps.back().energy_J);
}

TEST_CASE("a free swing at large amplitude gains no energy, and damping brings it to rest") {
    for (const int order : {1, 2}) {
        Description d = beam(order, 10, 60);
        const Trajectory swing = solve(d, {.steps = 80, .duration = 0.8, .dynamics = Dynamics{}});
        REQUIRE_MESSAGE(swing.converged, swing.message);
        double energy = 0;
        double largest_kinetic = 0;
        for (const Step& step : swing.steps) {
            largest_kinetic = std::max(largest_kinetic, step.kinetic_energy_J);
            // With 19 steps per period the second-order formula temporarily increases the energy by a percent.
            CHECK(step.energy_J + step.kinetic_energy_J <= energy + 0.015 * largest_kinetic + 1e-15);
            energy = std::min(energy, step.energy_J + step.kinetic_energy_J);
        }
        const Step& last = swing.steps.back();
        CHECK(last.energy_J + last.kinetic_energy_J <= energy + 2e-3 * largest_kinetic);
        for (const Damping& damping : {Damping{20, 0}, Damping{0, 0.02}}) {
            const Trajectory damped = solve(d, {.steps = 80, .duration = 1.6, .dynamics = Dynamics{damping}});
            REQUIRE_MESSAGE(damped.converged, damped.message);
            const Trajectory still = solve(d, {.steps = 4, .tolerance = 1e-6});
            CHECK(damped.steps.back().kinetic_energy_J < 1e-3 * largest_kinetic);
            CHECK(damped.steps.back().markers[0].position_m.z ==
                  near(still.steps.back().markers[0].position_m.z, {.relative = 0.02}));
        }
    }
}

TEST_CASE("stiffness damping acts on deformation only, not on a body that its support moves at constant speed") {
    constexpr double way = 0.5, duration = 1;
    Description d = beam(2, 10, 0);
    d.supports[0].move_m = {way, 0, way};
    d.supports[0].share = {{0, duration}, {0, 1}};
    const Trajectory carried =
        solve(d, {.steps = 50, .duration = duration, .tolerance = 1e-5, .dynamics = Dynamics{Damping{0, 0.02}}});
    REQUIRE_MESSAGE(carried.converged, carried.message);
    const Step& last = carried.steps.back();
    // What the start shook has come to rest.
    const double mass = beam_density * beam_length * beam_thickness * beam_thickness;
    CHECK(last.kinetic_energy_J == near(0.5 * mass * 2 * way * way, {.relative = 1e-3}));
    CHECK(last.markers[0].position_m.x == near(beam_length + way, {.relative = 1e-4}));
    CHECK(last.markers[0].position_m.z == near(beam_thickness / 2 + way, {.relative = 1e-4}));
    const double weight = 9.81 * mass;
    CHECK(norm(last.supports[0].force_N) < 1e-2 * weight);
}
