// What must hold of the robots that nothing holds, whatever their numbers are: a crawler gets nowhere without friction,
// nor with a gait that is the same forwards and backwards; with friction every cycle takes it further; a swimmer gets
// nowhere without water; a motor does the work that bends a bar. The examples' own numbers are in their expected.json.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/core/near.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;

namespace {

using robot::testing::run_file;

/// Where the middle of the robot is at a time, along x: the mean of two markers.
double along(const sim::Trajectory& t, double time_s, std::size_t first, std::size_t second) {
    for (const sim::Step& step : t.steps) {
        if (std::abs(step.time - time_s) < 1e-6)
            return 0.5 * (step.markers.at(first).position_m.x + step.markers.at(second).position_m.x);
    }
    FAIL("no step at ", time_s, " s");
    return 0;
}

}  // namespace

TEST_CASE("an inchworm moves by the same distance in every cycle, and not at all without friction") {
    const sim::Trajectory rough = run_file("examples/inchworm/robot.toml", {});
    const auto at = [&](double time_s) { return along(rough, time_s, 0, 2); };
    const std::array<double, 3> cycles = {at(0.6) - at(0), at(1.2) - at(0.6), at(1.8) - at(1.2)};
    MESSAGE("by cycle: ", 1e3 * cycles[0], ", ", 1e3 * cycles[1], ", ", 1e3 * cycles[2], " mm");
    CHECK(cycles[1] > 1e-3);
    CHECK(cycles[2] == near(cycles[1], {.relative = 0.1}));
    const sim::Trajectory smooth = run_file("examples/inchworm/robot.toml", {"parameters.friction=0"});
    CHECK(std::abs(along(smooth, 1.8, 0, 2) - along(smooth, 0, 0, 2)) < 0.02 * (at(1.8) - at(0)));
}

TEST_CASE("a crawler moves forward with a running arch, and not with a symmetric gait") {
    const auto gone = [](const std::string& gait, double seconds) {
        const sim::Trajectory t = run_file("examples/crawler/" + gait + ".toml", {});
        return along(t, seconds, 0, 1) - along(t, 0, 0, 1);
    };
    const double forward = gone("robot", 1.2), nod = gone("nod", 1.2);
    MESSAGE("forward ", 1e3 * forward, ", nodding ", 1e3 * nod, " mm");
    CHECK(forward > 2e-3);
    CHECK(std::abs(nod) < 0.1 * forward);
}

TEST_CASE("a swimmer moves by the drag of the water on its tail, and not in a vacuum") {
    const auto gone = [](const std::vector<std::string>& changes) {
        const sim::Trajectory t = run_file("examples/swimmer/robot.toml", changes);
        return along(t, 2, 0, 1) - along(t, 0, 0, 1);
    };
    const double in_water = gone({}), in_vacuum = gone({"fluid.drag_normal=0", "fluid.drag_tangential=0"});
    MESSAGE("in water ", 1e3 * in_water, ", in a vacuum ", 1e3 * in_vacuum, " mm");
    CHECK(in_water < -5e-3);
    CHECK(std::abs(in_vacuum) < 0.05 * std::abs(in_water));
}

TEST_CASE("the work of the crank's motor equals the elastic energy of the bent bar") {
    const sim::Trajectory t = run_file("examples/crank_and_rod/robot.toml", {"program.steps=60"});
    double work_J = 0;
    for (std::size_t k = 1; k < t.steps.size(); ++k) {
        const sim::JointState &before = t.steps[k - 1].joints.at(2), &now = t.steps[k].joints.at(2);
        work_J += 0.5 * (before.effort + now.effort) * (now.coordinate - before.coordinate);
    }
    CHECK(t.steps.back().joints.at(2).coordinate == near(150 * 3.14159265358979 / 180, {.relative = 1e-3}));
    CHECK(work_J == near(t.steps.back().energy_J, {.relative = 5e-3}));
}
