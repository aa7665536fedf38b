// An interactively controlled robot ends in the same state as a program, whatever the path.
#include "simulation/run/live.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"
#include "simulation/run/test_bar.hpp"
#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;
using testing::bar_side;
using testing::hollow_block;
using testing::model_of;

namespace {

/// The bar with a cable along its upper side.
Description bar_with_flexor(const CableTarget& target) {
    Description d = testing::bar(1);
    d.cables = {testing::flexor(d.mesh, target)};
    return d;
}

/// Until it arrives; every state on the way must be converged. The number of pieces.
int follow(Live& live, const LiveTarget& target, double tolerance) {
    const Progress silent;
    for (int piece = 1; piece <= 200; ++piece) {
        const LiveProgress progress = live.advance(target, silent);
        REQUIRE_MESSAGE(progress.reason.empty(), progress.reason);
        CHECK(live.describe().residual <= tolerance);
        if (progress.arrived) return piece;
    }
    FAIL("never arrived");
    return 0;
}

Vec3 tip(const Live& live) {
    return live.describe().markers.front().position_m;
}

}  // namespace

TEST_CASE("a cable pulled interactively moves the tip as the program does, and back") {
    const Program program{.steps = 10, .tolerance = 1e-6};
    const Description d = bar_with_flexor({CableTarget::Kind::length_ratio, 0.85});
    const Trajectory expected = testing::solve(d, program);
    REQUIRE(expected.converged);
    const Model model = model_of(d);
    Live live(model, program);
    LiveTarget target = live.target_at(0);
    target.drives[0] = {Drive::Kind::measure, 0.85 * live.rest_measures()[0]};
    CHECK(follow(live, target, 1e-6) > 2);  // in bounded pieces
    CHECK(norm(tip(live) - expected.steps.back().markers.front().position_m) < 1e-6 * bar_side);
    CHECK(live.describe().cables[0].tension_N == near(expected.steps.back().cables[0].tension_N, {.relative = 1e-6}));

    target.drives[0] = live.hold(0, Drive::Kind::multiplier);  // driven by its tension, it stays
    CHECK(live.advance(target, Progress()).arrived);
    CHECK(norm(tip(live) - expected.steps.back().markers.front().position_m) < 1e-6 * bar_side);
    target.drives[0].value = 0;
    follow(live, target, 1e-6);
    CHECK(norm(tip(live) - expected.steps.front().markers.front().position_m) < 1e-5 * bar_side);
}

TEST_CASE("inputs that are not driven follow the program's time") {
    Description d = bar_with_flexor({CableTarget::Kind::length_ratio, 1});
    d.gravity_m_s2 = {0, 0, -50};
    const Program program{.steps = 5, .tolerance = 1e-6};
    const Trajectory expected = testing::solve(d, program);
    const Model model = model_of(d);
    Live live(model, program);
    LiveTarget target = live.target_at(1);
    follow(live, target, 1e-6);
    CHECK(norm(tip(live) - expected.steps.back().markers.front().position_m) < 1e-5 * bar_side);
}

TEST_CASE("a chamber inflated interactively has the pressure of the program") {
    Description d = hollow_block(1);
    d.chambers[0].target = {ChamberTarget::Kind::volume_ratio, 1.3};
    const Program program{.steps = 6, .tolerance = 1e-6};
    const Trajectory expected = testing::solve(d, program);
    const Model model = model_of(d);
    Live live(model, program);
    follow(live, live.target_at(1), 1e-6);
    CHECK(live.describe().chambers[0].pressure_Pa ==
          near(expected.steps.back().chambers[0].pressure_Pa, {.relative = 1e-5}));
}

TEST_CASE("interactive control: a pull on the body acts as a dead load of its force, and can be released") {
    Description d = bar_with_flexor({CableTarget::Kind::tension_N, 0});
    const Program program{.steps = 5, .tolerance = 1e-7};
    const Model model = model_of(d);
    Live live(model, program);
    const Vec3 rest = tip(live);
    LiveTarget target = live.target_at(0);
    target.pull = Pull{d.markers.front().point, rest + Vec3{0, 0.3 * bar_side, bar_side}};
    follow(live, target, 1e-7);
    const Vec3 force = live.pull_force_N();
    const Vec3 moved = tip(live) - rest;
    CHECK(moved.z > 0.5 * bar_side);  // it follows the handle most of the way

    Load load{"pull", d.markers.front().point.nodes, d.markers.front().point.weights, force};
    d.loads = {load};
    const Trajectory expected = testing::solve(d, program);
    CHECK(norm(tip(live) - expected.steps.back().markers.front().position_m) < 1e-4 * bar_side);

    target.pull = std::nullopt;
    follow(live, target, 1e-7);
    CHECK(norm(tip(live) - rest) < 1e-4 * bar_side);
}
