// The cable finger of the SoftRobots examples (softrobots/README.md of the reference data), from rest to 50 mm of pull.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/core/near.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;

namespace {

/// Supports, cable and material as that README gives them.
std::string cable_finger(const std::string& mesh, int order, int steps) {
    const std::string folder = std::getenv("PLIANT_REFERENCE_DATA");
    return fmt::format(R"(
name = "cable finger"
length_unit = "mm"
[material.silicone]
youngs_modulus = "600 kPa"
poisson_ratio = 0.45
density = "4052 kg/m^3"
[mesh]
file = "{}/softrobots/cable_finger/{}"
order = {}
[[body]]
name = "finger"
region = "all"
material = "silicone"
[[fixed]]
name = "base"
box = [[-15, 0, 0], [5, 10, 15]]
[[cable]]
name = "flexor"
anchor = "first"
points = [[0, 12.5, 2.5], [-17.5, 12.5, 2.5], [-32.5, 12.5, 2.5], [-47.5, 12.5, 2.5], [-62.5, 12.5, 2.5],
  [-77.5, 12.5, 2.5], [-83.5, 12.5, 4.5], [-85.5, 12.5, 6.5], [-85.5, 12.5, 8.5], [-83.5, 12.5, 10.5],
  [-77.5, 12.5, 12.5], [-62.5, 12.5, 12.5], [-47.5, 12.5, 12.5], [-32.5, 12.5, 12.5], [-17.5, 12.5, 12.5]]
target = {{ shortening = "50 mm" }}
[[marker]]
name = "tip"
box = [[-103.5, -1, -1], [-103.3, 16, 16]]
[program]
steps = {}
)",
                       folder, mesh, order, steps);
}

sim::Trajectory simulate_text(const std::string& text) {
    return robot::testing::run(robot::testing::build_text(text));
}

void check_pull(const sim::Trajectory& result) {
    REQUIRE_MESSAGE(result.converged, result.message);
    double tension = 0;
    for (const sim::Step& step : result.steps) {
        CHECK(step.min_J > 0);
        CHECK(step.residual <= 1e-4);
        CHECK(step.cables[0].tension_N >= tension);  // tension increases until the flanks meet
        tension = step.cables[0].tension_N;
    }
    const sim::Step& last = result.steps.back();
    CHECK(result.steps.front().cables[0].length_m == near(0.157806, {.relative = 1e-5}));
    CHECK(last.cables[0].length_m == near(0.107806, {.relative = 1e-5}));
    CHECK(last.markers[0].position_m.y > result.steps.front().markers[0].position_m.y + 0.03);  // bends towards +y
}

}  // namespace

TEST_CASE("finger.vtk, linear and quadratic, is pulled by 0 to 50 mm") {
    const auto linear = robot::testing::build(robot::parse_robot(cable_finger("finger.vtk", 1, 25), "finger.toml"));
    CHECK(linear.model.description().supports[0].nodes.size() == 20);
    check_pull(robot::testing::run(linear));
    check_pull(simulate_text(cable_finger("finger.vtk", 2, 25)));
}

TEST_CASE("finger_7k.vtk, linear, is pulled by 0 to 50 mm") {
    check_pull(simulate_text(cable_finger("finger_7k.vtk", 1, 25)));
}

namespace {

/// The pneunet of softrobots/README.md with its stiff layer, and a target for its air.
std::string pneunet(const std::string& target, int steps) {
    const std::string folder = std::getenv("PLIANT_REFERENCE_DATA");
    return fmt::format(R"(
name = "pneunet"
length_unit = "mm"
material.soft = {{ youngs_modulus = "500 kPa", poisson_ratio = 0.3 }}
material.stiff = {{ youngs_modulus = "2000 kPa", poisson_ratio = 0.3 }}
mesh = {{ file = "{0}/softrobots/pneunet_finger/pneunetCut.vtk", order = 1 }}
[[body]]
name = "finger"
region = "all"
material = "soft"
[[body]]
name = "layer"
region = "all"
box = [[-100, 22.5, -8], [-19, 28, 8]]
material = "stiff"
[[fixed]]
name = "base"
box = [[-10, 0, -20], [0, 30, 20]]
[[chamber]]
name = "air"
surface = "{0}/softrobots/pneunet_finger/pneunetCavityCut.stl"
target = {{ {1} }}
[program]
steps = {2}
)",
                       folder, target, steps);
}

}  // namespace

TEST_CASE("with self-contact the finger is pulled by 75 mm, well past the touching of its flanks") {
    std::string text = cable_finger("finger_7k.vtk", 1, 30) + "[contact]\n";
    text.replace(text.find("50 mm"), 5, "75 mm");
    const sim::Trajectory result = simulate_text(text);
    REQUIRE_MESSAGE(result.converged, result.message);
    CHECK(result.warnings.empty());
    double before = 0;
    for (const sim::Step& step : result.steps) {
        CHECK(step.residual <= 1e-4);
        CHECK(step.min_J > 0);
        CHECK(step.smallest_distance_m > 0);
        CHECK(step.cables[0].tension_N >= before);  // closed flanks only increase the stiffness
        before = step.cables[0].tension_N;
    }
    CHECK(result.steps.back().self_contact_N > 10);
    CHECK(result.steps[10].self_contact_N == 0);
}

TEST_CASE("the pneunet inflates to 4.5 times its volume, past its largest pressure") {
    const sim::Trajectory grown = simulate_text(pneunet("volume_ratio = 4.5", 30));
    REQUIRE_MESSAGE(grown.converged, grown.message);
    CHECK(grown.iterations.size() < 800);  // a solver that crawls along its folds takes thousands
    double highest = 0;
    for (const sim::Step& step : grown.steps) highest = std::max(highest, step.chambers[0].pressure_Pa);
    CHECK(grown.steps.back().chambers[0].pressure_Pa < highest);
    CHECK(grown.steps.back().chambers[0].volume_ratio == near(4.5, {.relative = 1e-6}));

    // With pressure control it stops at the maximum, keeps the results so far, and says so.
    const sim::Trajectory pressed = simulate_text(pneunet("pressure = \"150 kPa\"", 30));
    CHECK_FALSE(pressed.converged);
    CHECK(pressed.message.find("its pressure has a maximum of") != std::string::npos);
    CHECK(pressed.steps.back().chambers[0].pressure_Pa > 0.9 * highest);
}

TEST_CASE("a mesh with many slivers inflates by 146 %") {
    const std::string folder = std::getenv("PLIANT_REFERENCE_DATA");
    const sim::Trajectory result = simulate_text(fmt::format(R"(
name = "bellows"
length_unit = "cm"
material.soft = {{ youngs_modulus = "500 kPa", poisson_ratio = 0.3 }}
mesh = {{ file = "{0}/softrobots/springy/Springy.vtk", order = 1 }}
body = [{{ name = "bellows", region = "all", material = "soft" }}]
fixed = [{{ name = "base", box = [[-2.001, -2.001, -0.001], [2.001, 2.001, 0.5]] }}]
[[chamber]]
name = "air"
surface = "{0}/softrobots/springy/Springy_Cavity.stl"
target = {{ volume_ratio = 2.46 }}
[program]
steps = 20
)",
                                                             folder));
    REQUIRE_MESSAGE(result.converged, result.message);
    CHECK(result.steps.back().chambers[0].volume_ratio == near(2.46, {.relative = 1e-9}));
    for (const sim::Step& step : result.steps) CHECK(step.min_J > 0);
}

TEST_CASE("pulled by 60 mm the coarse finger touches itself; without contact it crosses, with a warning") {
    std::string text = cable_finger("finger.vtk", 1, 24);
    text.replace(text.find("50 mm"), 5, "60 mm");
    const sim::Trajectory touching = simulate_text(text), always = simulate_text(text + "[contact]\n");
    const sim::Trajectory through = simulate_text(text + "[contact]\nself = false\n");
    REQUIRE_MESSAGE(always.converged, always.message);
    CHECK(always.steps.back().cables[0].tension_N == near(5.87, {.relative = 0.01}));
    for (const sim::Step& step : touching.steps) CHECK(step.met == (step.index >= 23));
    REQUIRE_MESSAGE(touching.converged, touching.message);
    REQUIRE_MESSAGE(through.converged, through.message);
    CHECK(touching.warnings.empty());
    CHECK(touching.steps.back().self_contact_N > 5);
    CHECK(touching.steps.back().cables[0].tension_N == near(5.87, {.relative = 0.01}));
    CHECK(through.steps.back().cables[0].tension_N == near(4.18, {.relative = 0.01}));
    REQUIRE(through.warnings.size() == 1);
    CHECK(through.warnings[0].find("from step 23 on, the robot passes through itself near (") == 0);
    for (const sim::Step& step : through.steps) CHECK(step.crossing_m.has_value() == (step.index >= 23));
}
