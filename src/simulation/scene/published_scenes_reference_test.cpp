// A robot of the SoftRobots examples in the scene in which it is published (softrobots/README.md of the reference
// data): on the ground, held by nothing.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cstdlib>
#include <string>

#include "base/core/near.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;

namespace {

constexpr double g = 9.81;

std::string data(const std::string& file) {
    return std::string(std::getenv("PLIANT_REFERENCE_DATA")) + "/softrobots/" + file;
}

sim::Trajectory run(const std::string& text) {
    return robot::testing::run_to_the_end(robot::testing::build(robot::parse_robot(text, "scene.toml")));
}

}  // namespace

TEST_CASE("the tripod rests on the ground, and the contact force equals its weight") {
    const sim::Trajectory lies = run(fmt::format(R"(
name = "tripod"
length_unit = "mm"
material.silicone = {{ youngs_modulus = "250 kPa", poisson_ratio = 0.45, density = "1427 kg/m^3" }}
mesh = {{ file = "{}", order = 1 }}
body = [{{ name = "tripod", region = "all", material = "silicone" }}]
contact = {{ distance = "0.1 mm" }}
obstacle = [{{ name = "ground", plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }}, friction = 0.5 }}]
[program]
steps = 4
gravity = [0, 0, -9.81]
)",
                                                 data("tripod/tripod_mid.gidmsh")));
    CHECK(lies.steps.back().contacts[0].force_N.z == near(0.032 * g, {.relative = 0.01}));
    for (const std::string& warning : lies.warnings) CHECK(warning.find("leaves open") == std::string::npos);
}
