#include "simulation/solver/friction_rounds.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "base/core/near.hpp"
#include "simulation/run/live.hpp"
#include "simulation/run/test_bar.hpp"
#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;
using testing::bar_side;

namespace {

/// A bar of 4 x 1 x 1 cm along x whose cable drags in its guides, to be shortened to 0.85 in one step.
Model dragging_bar(double friction = 0.4) {
    Description d;
    d.mesh = reference::kuhn_box({4 * bar_side, bar_side, bar_side}, 8, 2, 2, [](Vec3) { return 0; });
    d.materials = {{"A", material::neo_hookean(1e6, 0.4), 1000}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    Cable cable = testing::flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.85});
    cable.friction = friction;
    d.cables = {cable};
    auto model = Model::create(std::move(d));
    REQUIRE(model);
    return std::move(*model);
}

struct Settled {
    StepOutcome outcome;
    double residual, length;  ///< with the friction of the state itself
};

Settled settle(const Model& model, double tolerance, int rounds) {
    const Equilibrium system(model);
    const FactoredLaplacian laplacian(system);
    SolverChain solvers = make_chain(Solver::automatic, system, laplacian);
    const State rest = system.rest();
    const Controls at_rest = system.controls(0);
    const std::vector<Drive> wanted = system.controls(1).drives;
    Controls controls = system.controls(1);
    State state = rest;
    const Progress silent;
    Settled result{settle_friction(system, solvers, {.tolerance = tolerance}, rounds, {rest, at_rest, at_rest.drives},
                                   controls, state, silent),
                   0, 0};
    Controls anew = system.controls(1);
    system.freeze_cable_friction(state.x, wanted, at_rest.drives, anew);
    result.residual = system.evaluate(state, anew).residual;
    result.length = system.cable_friction_error(state, wanted);
    return result;
}

}  // namespace

TEST_CASE("remaining friction error: converged within the tolerance, loose within ten times it, failed beyond") {
    const Model model = dragging_bar();
    int settled = 0, loose = 0, refused = 0;
    for (const int rounds : {1, 2, 3, 4, 6, 30}) {
        for (const double tolerance : {1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6}) {
            CAPTURE(rounds);
            CAPTURE(tolerance);
            const Settled s = settle(model, tolerance, rounds);
            const bool within = s.residual <= tolerance && s.length <= 0.1 * tolerance;
            const bool close = s.residual <= 10 * tolerance && s.length <= tolerance;
            CHECK(s.outcome.evaluation.residual == near(s.residual, {.relative = 1e-9}));
            CHECK(s.outcome.converged == close);
            CHECK(s.outcome.loose == (close && !within));
            CHECK(s.outcome.reason.empty() == within);
            settled += within ? 1 : 0;
            loose += close && !within ? 1 : 0;
            refused += close ? 0 : 1;
        }
    }
    CHECK(settled > 0);
    CHECK(loose > 0);
    CHECK(refused > 0);
}

TEST_CASE("each round of a cable with friction converges as that of a cable without") {
    const Settled with = settle(dragging_bar(), 1e-6, 30), without = settle(dragging_bar(0), 1e-6, 30);
    REQUIRE(with.outcome.converged);
    CHECK(with.outcome.iterations < 3 * without.outcome.iterations);
}

TEST_CASE("interactive control settles friction like a program") {
    const Model model = dragging_bar();
    const Program program{.steps = 6, .tolerance = 1e-5};
    Live live(model, program);
    const Progress silent;
    LiveProgress progress;
    for (int piece = 0; piece < 100 && !progress.arrived; ++piece) {
        progress = live.advance(live.target_at(1), silent);
        REQUIRE_MESSAGE(progress.reason.empty(), progress.reason);
        const Step step = live.describe();
        CHECK(step.converged);
        CHECK(step.residual <= 1e-5);
    }
    CHECK(live.describe().cables[0].length_ratio == near(0.85, {.relative = 1e-6}));
}

TEST_CASE("rounds are given up where their rate does not lead to the error wanted, and not before it shows") {
    const auto shrinking = [](double rate, int rounds) {
        std::vector<double> misfits;
        for (int k = 0; k < rounds; ++k) misfits.push_back(0.1 * std::pow(rate, k));
        return misfits;
    };
    CHECK_FALSE(rounds_are_vain(shrinking(0.98, 7), 30, 1e-3));
    CHECK(rounds_are_vain(shrinking(0.98, 8), 30, 1e-3));
    CHECK(rounds_are_vain(shrinking(1.1, 8), 30, 1e-3));
    CHECK_FALSE(rounds_are_vain(shrinking(0.8, 8), 30, 1e-3));
    CHECK(rounds_are_vain(shrinking(0.8, 8), 20, 1e-3));
    CHECK_FALSE(rounds_are_vain(shrinking(0.5, 12), 12, 1e-3));
    // It alternates, but shrinks from one pair of rounds to the next.
    CHECK_FALSE(rounds_are_vain(std::vector<double>{1, 0.1, 0.5, 0.05, 0.25, 0.025, 0.125, 0.0125, 0.0625}, 30, 1e-3));
}
