// What must hold of the robots that nothing holds, whatever their numbers are: a crawler gets nowhere without friction,
// nor with a gait that is the same forwards and backwards; with friction every cycle takes it further. The examples' own
// numbers are in their expected.json.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <filesystem>

#include "base/core/near.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/mesh/mass_properties.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;

namespace {

using robot::testing::run_file;

const std::vector<std::string> quick = {"mesh.order=1", "mesh.size=6 mm"};

std::vector<std::string> with(std::vector<std::string> more) {
    more.insert(more.begin(), quick.begin(), quick.end());
    return more;
}

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

TEST_CASE("an inchworm gets on by as much in every cycle, by friction alone") {
    const sim::Trajectory rough = run_file("examples/inchworm/robot.toml", with({"program.time_step=20 ms"}));
    const auto at = [&](double time_s) { return along(rough, time_s, 0, 2); };
    const std::array<double, 3> cycles = {at(0.6) - at(0), at(1.2) - at(0.6), at(1.8) - at(1.2)};
    MESSAGE("by cycle: ", 1e3 * cycles[0], ", ", 1e3 * cycles[1], ", ", 1e3 * cycles[2], " mm");
    CHECK(cycles[1] > 1e-3);
    CHECK(cycles[2] == near(cycles[1], {.relative = 0.1}));
    const sim::Trajectory smooth =
        run_file("examples/inchworm/robot.toml", with({"program.time_step=20 ms", "parameters.friction=0"}));
    CHECK(std::abs(along(smooth, 1.8, 0, 2) - along(smooth, 0, 0, 2)) < 0.02 * (at(1.8) - at(0)));
}

TEST_CASE("a crawler goes forward, back and round by its gaits, and nowhere by one that is symmetric") {
    const auto gone = [](const std::string& gait, double seconds) {
        const sim::Trajectory t = run_file("examples/crawler/" + gait + ".toml", with({"mesh.size=8 mm"}));
        return along(t, seconds, 0, 1) - along(t, 0, 0, 1);
    };
    const double forward = gone("robot", 1.2), back = gone("back", 1.2), nod = gone("nod", 1.2);
    MESSAGE("forward ", 1e3 * forward, ", back ", 1e3 * back, ", nodding ", 1e3 * nod, " mm");
    CHECK(forward > 2e-3);
    CHECK(back == near(-forward, {.relative = 0.1}));
    CHECK(std::abs(nod) < 0.1 * forward);
}

TEST_CASE("the egg is what its script says") {
    const auto egg = mesh::read_surface("examples/gripper_picks_up/egg.stl");
    REQUIRE(egg.has_value());
    // The volume of the solid of revolution, pi int r(z)^2 dz with r = 11 (1 - 0.18 (z + 1)) sqrt(1 - z^2), dz 14 mm.
    double volume = 0;
    constexpr int slices = 1000;
    for (int k = 0; k < slices; ++k) {
        const double z = -1 + (k + 0.5) * 2 / slices, r = 11 * (1 - 0.18 * (z + 1)) * std::sqrt(1 - z * z);
        volume += 3.14159265358979 * r * r * 14 * 2 / slices;
    }
    CHECK(mesh::mass_properties(egg->mesh).volume == near(volume, {.relative = 0.03}));
    CHECK(mesh::mass_properties(egg->mesh).volume < volume);  // its corners are on it
}
