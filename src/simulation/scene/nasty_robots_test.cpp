// Difficult robots: each gives either a correct answer or a message that explains why there is none.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;
using namespace pliant::robot;
using robot::testing::check_problem;

namespace {

sim::Trajectory simulate(const std::string& text) {
    return robot::testing::run(robot::testing::build(parse_robot(text, "nasty.toml")));
}

sim::Trajectory simulate_to_the_end(const std::string& text) {
    sim::Trajectory result = simulate(text);
    REQUIRE_MESSAGE(result.converged, result.message);
    return result;
}

std::string said(const sim::Trajectory& result) {
    std::string all = result.message;
    for (const std::string& warning : result.warnings) all += "\n" + warning;
    return all;
}

bool says(const sim::Trajectory& result, const std::string& text) {
    return said(result).find(text) != std::string::npos;
}

/// Lengths in mm.
std::string robot_of(const std::string& rest) {
    return "name = \"nasty\"\nlength_unit = \"mm\"\n"
           "material.rubber = { youngs_modulus = \"1 MPa\", poisson_ratio = 0.3 }\n" +
           rest;
}

/// A bar of 10 x 10 x 60 mm along z from two blocks, held at its foot, with what hangs on its end.
std::string bar_of_two_blocks(const std::string& lower, const std::string& upper, const std::string& rest) {
    return robot_of(fmt::format(R"(
{}
[[body]]
name = "lower"
geometry = {{ box = [[0, 0, 0], [10, 10, 30]] }}
material = "{}"
[[body]]
name = "upper"
geometry = {{ box = [[0, 0, 30], [10, 10, 60]] }}
material = "{}"
[mesh]
size = "4 mm"
[[fixed]]
name = "foot"
plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }}
[[marker]]
name = "end"
box = [[-1, -1, 59.9], [11, 11, 60.1]]
)",
                                rest, lower, upper));
}

double rise_mm(const sim::Trajectory& t, std::size_t marker = 0) {
    return 1e3 * (t.steps.back().markers[marker].position_m.z - t.steps.front().markers[marker].position_m.z);
}

}  // namespace

/// A strip of 40 x 8 mm and 0.5 mm thick, clamped at both ends and free to move in its plane of 40 mm only.
double sag_mm(double pressure_Pa, int steps) {
    const sim::Trajectory result = simulate_to_the_end(robot_of(fmt::format(R"(
[[body]]
name = "strip"
geometry = {{ box = [[0, 0, 0], [40, 8, 0.5]] }}
material = "rubber"
[mesh]
size = "2 mm"
[[fixed]]
name = "left"
plane = {{ point = [0, 0, 0], normal = [1, 0, 0] }}
[[fixed]]
name = "right"
plane = {{ point = [40, 0, 0], normal = [1, 0, 0] }}
[[fixed]]
name = "front"
plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}
directions = "normal"
[[fixed]]
name = "back"
plane = {{ point = [0, 8, 0], normal = [0, 1, 0] }}
directions = "normal"
[[load]]
name = "air"
plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }}
pressure = "{} Pa"
[[marker]]
name = "middle"
point = [20, 4, 0.25]
[program]
steps = {}
)",
                                                                            pressure_Pa, steps)));
    return rise_mm(result);
}

TEST_CASE("membrane: a strip 80 times as long as thick bends as a plate at low pressure, and as a skin at high") {
    const double E = 1e6 / (1 - 0.09), t = 0.5e-3, L = 0.04;
    const double plate_mm = 1e3 * 0.05 * std::pow(L, 4) / (32 * E * std::pow(t, 3));
    CHECK(sag_mm(0.05, 1) / plate_mm == near(1, {.relative = 0.03}));
    // A skin without stiffness against bending, its arc taken as a parabola; it grows by 4 %.
    const double skin_mm = 1e3 * std::cbrt(3 * 500 * std::pow(L, 4) / (64 * E * t));
    CHECK(sag_mm(500, 10) / skin_mm == near(1, {.relative = 0.06}));
}

TEST_CASE("column: above its critical load it buckles sideways, or a warning says that it is unstable") {
    const double I = 8 * std::pow(5, 3) / 12 * 1e-12,
                 critical_N = std::numbers::pi * std::numbers::pi * 1e6 * I / (4 * 0.01);
    const sim::Trajectory result = simulate(robot_of(fmt::format(R"(
[[body]]
name = "column"
geometry = {{ box = [[0, 0, 0], [5, 8, 100]] }}
material = "rubber"
[mesh]
size = "4 mm"
[[fixed]]
name = "foot"
plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }}
[[load]]
name = "weight"
plane = {{ point = [0, 0, 100], normal = [0, 0, 1] }}
force = ["0 N", "0 N", "{} N"]
[[marker]]
name = "end"
box = [[-1, -1, 99.9], [9, 9, 100.1]]
[program]
steps = 14
)",
                                                                 -1.4 * critical_N)));
    const Vec3 moved = result.steps.back().markers[0].position_m - result.steps.front().markers[0].position_m;
    const bool fell = std::hypot(moved.x, moved.y) > 0.01;
    CHECK_MESSAGE((fell || says(result, "unstable")), said(result));
}

TEST_CASE("arch: loaded at its crown it snaps through, and a warning says that it jumps") {
    std::string outline;
    for (const double radius : {60.0, 59.0}) {
        for (int k = 0; k <= 12; ++k) {
            const double angle = (radius > 59 ? 1 : -1) * (-0.4 + 0.8 * k / 12);
            outline += fmt::format("{}[{}, {}]", outline.empty() ? "" : ", ", radius * std::sin(angle),
                                   radius * std::cos(angle));
        }
    }
    const sim::Trajectory result = simulate(robot_of(fmt::format(R"(
[[body]]
name = "arch"
geometry = {{ prism = [{}], plane = "xz", from = 0, to = 4 }}
material = "rubber"
[mesh]
size = "2 mm"
[[fixed]]
name = "feet"
box = [[-30, -1, 0], [30, 5, 55.3]]
[[load]]
name = "weight"
box = [[-1.5, -1, 59.5], [1.5, 5, 61]]
force = ["0 N", "0 N", "-0.1 N"]
[[marker]]
name = "crown"
point = [0, 2, 59.5]
[program]
steps = 20
)",
                                                                 outline)));
    REQUIRE_MESSAGE(result.converged, result.message);
    CHECK(rise_mm(result) < -6);  // below its feet
    CHECK_MESSAGE(says(result, "the robot jumps"), said(result));
}

TEST_CASE("a support of one node, and bodies joined at one edge, are refused before solving") {
    check_problem(robot_of(R"(
body = [{ name = "block", geometry = { box = [[0, 0, 0], [20, 10, 10]] }, material = "rubber" }]
fixed = [{ name = "pin", nodes = [0] }]
)"),
                  "body \"block\" can turn freely about the point (");
    check_problem(robot_of(R"(
[[body]]
name = "left"
geometry = { box = [[0, 0, 0], [10, 10, 10]] }
material = "rubber"
[[body]]
name = "right"
geometry = { box = [[10, 0, 10], [20, 10, 20]] }
material = "rubber"
[[fixed]]
name = "wall"
plane = { point = [0, 0, 0], normal = [1, 0, 0] }
)"),
                  "body \"right\" can turn freely about the line through (10, ");
}

TEST_CASE("slivers: two blocks misaligned by 0.01 mm stretch as aligned ones do") {
    const std::string pull =
        "load = [{ name = \"pull\", plane = { point = [0, 0, 60], normal = [0, 0, 1] }, "
        "force = [\"0 N\", \"0 N\", \"5 N\"] }]\nprogram = { steps = 2 }\n";
    std::string out = bar_of_two_blocks("rubber", "rubber", pull);
    const std::string straight = "[[0, 0, 30], [10, 10, 60]]";
    out.replace(out.find(straight), straight.size(), "[[0.01, 0.01, 30], [10.01, 10.01, 60]]");
    const sim::Trajectory shifted = simulate_to_the_end(out),
                          aligned = simulate_to_the_end(bar_of_two_blocks("rubber", "rubber", pull));
    CHECK(rise_mm(shifted) / rise_mm(aligned) == near(1, {.relative = 3e-3}));
}

TEST_CASE("vacuum: a collapsing box touches itself inside, or the run names the step where it stopped") {
    const sim::Trajectory result = simulate(robot_of(R"(
[[body]]
name = "box"
geometry = { difference = [{ box = [[0, 0, 0], [24, 24, 12]] }, { box = [[2, 2, 2], [22, 22, 10]] }] }
material = "rubber"
[mesh]
size = "3 mm"
[[fixed]]
name = "floor"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[[chamber]]
name = "air"
inside = [12, 12, 6]
target = { pressure = "-40 kPa" }
[program]
steps = 10
)"));
    CHECK_FALSE_MESSAGE(says(result, "passes through itself"), said(result));
    if (!result.converged) CHECK_MESSAGE(says(result, "stopped at step"), said(result));
    for (const sim::Step& step : result.steps) {
        CHECK(step.min_J > 0);
        CHECK(step.chambers[0].volume_ratio > 0);
    }
}

TEST_CASE("a Poisson ratio of 0.4999: a bar stretched by 30 % has the force of incompressible rubber") {
    const sim::Trajectory result = simulate_to_the_end(robot_of(R"(
material.tight = { youngs_modulus = "1 MPa", poisson_ratio = 0.4999 }
[[body]]
name = "bar"
geometry = { box = [[0, 0, 0], [10, 10, 30]] }
material = "tight"
[mesh]
size = "4 mm"
[[fixed]]
name = "foot"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
directions = "normal"
[[fixed]]
name = "side"
plane = { point = [0, 0, 0], normal = [1, 0, 0] }
directions = "normal"
[[fixed]]
name = "front"
plane = { point = [0, 0, 0], normal = [0, 1, 0] }
directions = "normal"
[[fixed]]
name = "grip"
plane = { point = [0, 0, 30], normal = [0, 0, 1] }
directions = "normal"
move = [0, 0, 9]
[program]
steps = 3
)"));
    const double stretch = 1.3, nominal_Pa = 1e6 / 3 * (stretch - 1 / (stretch * stretch));
    CHECK(std::fabs(result.steps.back().supports[3].force_N.z) / (1e-4 * nominal_Pa) == near(1, {.relative = 1e-3}));
}

TEST_CASE("stiffness: of two blocks, the one 100,000 times softer deforms as computed") {
    const sim::Trajectory result = simulate_to_the_end(bar_of_two_blocks("soft", "hard", R"(
material.soft = { youngs_modulus = "10 kPa", poisson_ratio = 0 }
material.hard = { youngs_modulus = "1 GPa", poisson_ratio = 0 }
load = [{ name = "pull", plane = { point = [0, 0, 60], normal = [0, 0, 1] }, force = ["0 N", "0 N", "0.01 N"] }]
program = { steps = 1 }
)"));
    CHECK(rise_mm(result) / 0.3 == near(1, {.relative = 0.02}));
}

TEST_CASE("chamber: a ball inflated to eight times its air has the pressure of a thick rubber shell") {
    const sim::Trajectory result = simulate_to_the_end(robot_of(R"(
material.tight = { youngs_modulus = "1 MPa", poisson_ratio = 0.49 }
[[body]]
name = "ball"
geometry = { difference = [{ sphere = { center = [0, 0, 0], radius = 15 } }, { sphere = { center = [0, 0, 0], radius = 8 } }] }
material = "tight"
[mesh]
size = "5 mm"
[[fixed]]
name = "foot"
sphere = { center = [0, 0, -15], radius = 3 }
[[chamber]]
name = "air"
inside = [0, 0, 0]
target = { volume_ratio = 8 }
[program]
steps = 14
)"));
    CHECK(result.steps.back().chambers[0].volume_ratio / 8 == near(1, {.relative = 1e-4}));
    // Incompressible neo-Hookean shell: stretches of its inside and, by its volume, of its outside.
    const auto part = [](double stretch) { return 4 / stretch + std::pow(stretch, -4); };
    const double outer = std::cbrt(1 + 7 * std::pow(8.0 / 15, 3));
    const double pressure_Pa = 1e6 / 3 / 2 * (part(outer) - part(2));
    CHECK(result.steps.back().chambers[0].pressure_Pa / pressure_Pa == near(1, {.relative = 0.06}));
}

TEST_CASE("a guide point far outside the robot is refused, with its distance") {
    check_problem(
        bar_of_two_blocks(
            "rubber", "rubber",
            "cable = [{ name = \"flexor\", points = [[5, 5, 10], [30, 5, 40]], target = { length_ratio = 0.9 } "
            "}]\n"),
        "lies outside every body, by 20 mm");
}

TEST_CASE("inverted tets in a mesh file are turned back, or refused") {
    const pliant::test::Folder folder("nasty_tets");
    // Two tets on one face; the second with its corners the wrong way round.
    const auto mesh = [&](const std::string& second) {
        std::ofstream(folder / "two.vtk") << "# vtk DataFile Version 3.0\ntwo\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                                             "POINTS 5 double\n0 0 0\n10 0 0\n0 10 0\n0 0 10\n10 10 10\n"
                                             "CELLS 2 10\n4 0 1 2 3\n4 "
                                          << second << "\nCELL_TYPES 2\n10\n10\n";
        std::ofstream(folder / "robot.toml") << robot_of(R"(
mesh = { file = "two.vtk", order = 1 }
body = [{ name = "two", region = "all", material = "rubber" }]
fixed = [{ name = "floor", plane = { point = [0, 0, 0], normal = [0, 0, 1] } }]
load = [{ name = "push", sphere = { center = [10, 10, 10], radius = 20 }, force = ["0 N", "0 N", "1e-3 N"] }]
marker = [{ name = "end", point = [9, 9, 9] }]
program = { steps = 1 }
)");
        return load_robot(folder / "robot.toml");
    };
    const sim::Trajectory right = robot::testing::run_to_the_end(robot::testing::build(mesh("1 2 3 4")));
    const sim::Trajectory wrong = robot::testing::run_to_the_end(robot::testing::build(mesh("2 1 3 4")));
    CHECK(rise_mm(wrong) / rise_mm(right) == near(1, {.relative = 1e-12}));
}
