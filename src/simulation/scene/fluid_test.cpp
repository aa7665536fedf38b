// Bodies and objects in a fluid, from the robot file: buoyancy and drag against closed forms.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/mesh/test_shapes.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;
using robot::testing::g;
using robot::testing::run_text;

namespace {

/// A small clamped cube far away, a fluid, and an object in it.
std::string fluid_world(const std::string& fluid, const std::string& object, const std::string& program) {
    return R"(
name = "fluid"
length_unit = "mm"
[material.rubber]
youngs_modulus = "1 MPa"
poisson_ratio = 0.45
density = "1000 kg/m^3"
[[body]]
name = "post"
material = "rubber"
geometry = { box = [[-300, 0, -100], [-290, 10, -90]] }
[mesh]
size = "10 mm"
order = 1
[[fixed]]
name = "clamp"
plane = { point = [0, 0, -100], normal = [0, 0, 1] }
[contact]
distance = "0.2 mm"
[fluid]
)" + fluid +
           "\n[[object]]\nname = \"it\"\n" + object + "\n[program]\n" + program;
}

/// A free soft block in the same fluid.
std::string block(const std::string& fluid, const std::string& program, double density = 600) {
    return fmt::format(R"(
name = "block"
length_unit = "mm"
[material.foam]
youngs_modulus = "0.1 MPa"
poisson_ratio = 0.3
density = "{} kg/m^3"
[[body]]
name = "block"
material = "foam"
geometry = {{ box = [[0, 0, 0], [30, 30, 20]] }}
[mesh]
size = "10 mm"
[[marker]]
name = "top"
point = [15, 15, 20]
[[marker]]
name = "sole"
point = [15, 15, 0]
[fluid]
)",
                       density) +
           fluid + "\n[program]\n" + program;
}

const std::string down = "gravity = [0, 0, -9.81]\n";

}  // namespace

TEST_CASE("an object that floats stably is open in yaw and drift only, and its equilibrium is called stable") {
    const sim::Trajectory result =
        run_text(fluid_world("density = \"1000 kg/m^3\"\nlevel = 0",
                             "geometry = { box = [[-20, -20, -8], [20, 20, 12]] }\ndensity = \"400 kg/m^3\"",
                             "steps = 3\ngravity = [0, 0, -9.81]\n"));
    REQUIRE(result.converged);
    std::string said;
    for (const std::string& line : result.warnings) said += line + "\n";
    CHECK_MESSAGE(said.find("object \"it\" can slide in 2 directions and turn or roll in 1 way") != std::string::npos,
                  said);
    CHECK_MESSAGE(said.find("unstable") == std::string::npos, said);
}

TEST_CASE("a floating block displaces water of its weight, at equilibrium and in dynamics") {
    // 600/1000 of 20 mm; pressed together by a thousandth of that by the water.
    const sim::Trajectory still = run_text(block("density = \"1000 kg/m^3\"\nlevel = 10\n", "steps = 5\n" + down));
    const auto middle = [](const sim::Step& step) {
        return 0.5 * (step.markers[0].position_m.z + step.markers[1].position_m.z);
    };
    CHECK(middle(still.steps.back()) == near(10e-3 + 10e-3 - 12e-3, {.absolute = 0.05e-3}));
    const sim::Trajectory floats =
        run_text(fluid_world("density = \"1000 kg/m^3\"\nlevel = 10\ndrag_normal = 1\n",
                             "geometry = { box = [[0, 0, 0], [30, 30, 20]] }\ndensity = \"600 kg/m^3\"\n",
                             "duration = \"2 s\"\ntime_step = \"10 ms\"\nmass_damping = 10\n" + down));
    CHECK(floats.steps.back().objects[0].position_m.z == near(8e-3, {.absolute = 0.01e-3}));
    CHECK(floats.steps.back().kinetic_energy_J < 1e-9);
}

TEST_CASE("a fluid does not enter closed cavities, whether they are chambers or not") {
    // A cube of 12 mm as heavy as the water of its material, with a cavity of 6 mm: the water lifts it by that.
    const auto cube = [](const std::string& geometry, const std::string& chamber) {
        return run_text(R"(
name = "cube"
length_unit = "mm"
[material.m]
youngs_modulus = "1 MPa"
poisson_ratio = 0.3
density = "1000 kg/m^3"
[[body]]
name = "b"
material = "m"
geometry = )" + geometry +
                        R"(
[mesh]
size = "4 mm"
[[fixed]]
name = "floor"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[fluid]
density = "1000 kg/m^3"
)" + chamber + "\n[program]\nsteps = 1\ntolerance = 1e-7\n" +
                        down)
            .steps.back()
            .supports[0]
            .force_N.z;
    };
    const std::string solid = "{ box = [[0, 0, 0], [12, 12, 12]] }";
    const std::string hole = "{ box = [[3, 3, 3], [9, 9, 9]] }";
    const std::string hollow = "{ difference = [" + solid + ", " + hole + "] }";
    const auto chamber = [](const std::string& air) {
        return "[[chamber]]\nname = \"air\"\ntarget = { pressure = \"0 kPa\" }\n" + air + "\n";
    };
    const double lift = -1000 * g * 6e-3 * 6e-3 * 6e-3;
    CHECK(cube(solid, chamber("geometry = " + hole)) == near(lift, {.relative = 2e-3}));
    CHECK(cube(hollow, chamber("inside = [6, 6, 6]")) == near(lift, {.relative = 2e-3}));
    CHECK(cube(hollow, "") == near(lift, {.relative = 2e-3}));
    const test::Folder folder("fluid_in_cavities");  // the mesh need not match a surface
    REQUIRE(mesh::write_stl(folder.path() / "cavity.stl", mesh::test::cube({3, 3, 3}, 6)));
    const std::string surface = fmt::format("surface = \"{}\"", (folder.path() / "cavity.stl").string());
    CHECK(cube(hollow, chamber(surface)) == near(lift, {.relative = 2e-3}));
}

TEST_CASE("where a support closes the mouth of a chamber, the fluid presses on the support and not on the robot") {
    const sim::Trajectory cup = run_text(R"(
name = "cup"
length_unit = "mm"
[material.m]
youngs_modulus = "10 MPa"
poisson_ratio = 0.3
density = "1000 kg/m^3"
[[body]]
name = "cup"
material = "m"
geometry = { difference = [{ box = [[0, 0, 0], [40, 20, 20]] }, { box = [[0, 5, 5], [30, 15, 15]] }] }
[mesh]
size = "5 mm"
[[fixed]]
name = "wall"
plane = { point = [0, 0, 0], normal = [1, 0, 0] }
[[chamber]]
name = "air"
geometry = { box = [[0, 5, 5], [30, 15, 15]] }
target = { pressure = "0 kPa" }
[fluid]
density = "1000 kg/m^3"
level = 1010
[program]
steps = 1
)" + down);
    REQUIRE(cup.converged);
    // The water presses the cup to the wall by its pressure on the mouth's area.
    CHECK(cup.steps.back().supports[0].force_N.x == near(1000 * g * 1 * 1e-4, {.relative = 1e-4}));
}

TEST_CASE("an object lighter than the displaced fluid rises, and a held one pulls with the difference") {
    const sim::Trajectory hangs = run_text(fluid_world(
        "density = \"1000 kg/m^3\"\n", "geometry = { sphere = { center = [0, 0, 0], radius = 10 } }\nmass = \"1 g\"\n",
        "duration = \"0.02 s\"\ntime_step = \"1 ms\"\n" + down));
    // Its volume is that of the polyhedron, less than the ball's.
    const double T = 0.02, volume = 4.0 / 3 * std::numbers::pi * 1e-6;
    const double rise = 0.5 * (1000 * volume - 1e-3) * g / 1e-3 * T * T;
    CHECK(hangs.steps.back().objects[0].position_m.z == near(rise, {.relative = 0.01}));
    const sim::Trajectory held = run_text(R"(
name = "held"
length_unit = "mm"
[material.foam]
youngs_modulus = "0.1 MPa"
poisson_ratio = 0.3
density = "200 kg/m^3"
[[body]]
name = "block"
material = "foam"
geometry = { box = [[0, 0, 0], [30, 30, 20]] }
[mesh]
size = "10 mm"
[[fixed]]
name = "floor"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[fluid]
density = "1000 kg/m^3"
level = 50
[program]
steps = 2
)" + down);
    CHECK(held.steps.back().supports[0].force_N.z == near(-(1000 - 200) * 18e-6 * g, {.relative = 0.01}));
}

TEST_CASE("a ball and a plate sink with the speed that the drag law gives") {
    const double radius = 10e-3, drag = 0.5;
    const sim::Trajectory ball =
        run_text(fluid_world(fmt::format("density = \"1000 kg/m^3\"\ndrag_normal = {}\n", drag),
                             "geometry = { sphere = { center = [0, 0, 0], radius = 10 } }\ndensity = \"2000 kg/m^3\"\n",
                             "duration = \"2 s\"\ntime_step = \"10 ms\"\n" + down));
    const auto speed = [](const sim::Trajectory& result) {
        const std::size_t n = result.steps.size() - 1;
        return (result.steps[n - 1].objects[0].position_m.z - result.steps[n].objects[0].position_m.z) / 0.01;
    };
    // (rho_s - rho) V g = rho/2 c pi r^2 v^2
    const double v = std::sqrt(1000 * 4.0 / 3 * radius * g / (0.5 * 1000 * drag));
    CHECK(speed(ball) == near(v, {.relative = 0.01}));
    const sim::Trajectory plate =
        run_text(fluid_world("density = \"1000 kg/m^3\"\ndrag_normal = 0.9\n",
                             "geometry = { box = [[0, 0, 0], [40, 40, 4]] }\ndensity = \"2000 kg/m^3\"\n",
                             "duration = \"2 s\"\ntime_step = \"10 ms\"\n" + down));
    CHECK(speed(plate) == near(std::sqrt(1000 * 4e-3 * g / (0.5 * 1000 * 2 * 0.9)), {.relative = 0.005}));
}

TEST_CASE("a current carries bodies, and skin friction slows what slides edge-on") {
    const sim::Trajectory carried =
        run_text(fluid_world("density = \"1000 kg/m^3\"\ndrag_normal = 2\ncurrent = [0.3, 0, 0]\n",
                             "geometry = { box = [[0, 0, 0], [20, 20, 20]] }\ndensity = \"1000 kg/m^3\"\n",
                             "duration = \"4 s\"\ntime_step = \"20 ms\"\n"));
    const std::size_t n = carried.steps.size() - 1;
    const double v = (carried.steps[n].objects[0].position_m.x - carried.steps[n - 1].objects[0].position_m.x) / 0.02;
    // v' = k (0.3 - v)^2, k = rho c A / m: 1/(0.3 - v) grows by k t.
    const double k = 2.0 * 1000 * 4e-4 / 8e-3;
    CHECK(0.3 - v == near(1 / (1 / 0.3 + k * 3.99), {.relative = 0.05}));
    const sim::Trajectory slides = run_text(
        fluid_world("density = \"1000 kg/m^3\"\ndrag_tangential = 0.1\n",
                    "geometry = { box = [[0, 0, 0], [40, 40, 2]] }\ndensity = \"1000 kg/m^3\"\nvelocity = [1, 0, 0]\n",
                    "duration = \"0.2 s\"\ntime_step = \"1 ms\"\n"));
    // m v' = -rho/2 c A v^2 with both faces and both edges along it: x = ln(1 + k t)/k.
    const double q = 0.5 * 1000 * 0.1 * (2 * 16e-4 + 2 * 0.8e-4) / 3.2e-3;
    CHECK(slides.steps.back().objects[0].position_m.x - 0.02 == near(std::log(1 + q * 0.2) / q, {.relative = 0.005}));
}

TEST_CASE("a fluid with a level brakes also while no gravity acts") {
    const auto way = [](const std::string& level) {
        const sim::Trajectory result = run_text(fluid_world(
            "density = \"1000 kg/m^3\"\ndrag_normal = 1\n" + level,
            "geometry = { box = [[0, 0, -40], [20, 20, -20]] }\ndensity = \"1000 kg/m^3\"\nvelocity = [1, 0, 0]\n",
            "duration = \"0.1 s\"\ntime_step = \"2 ms\"\nkey = [{ time = \"0 s\", gravity = 0 }]\n" + down));
        return result.steps.back().objects[0].position_m.x - result.steps.front().objects[0].position_m.x;
    };
    // m v' = -rho c A v^2 with both ends across it: x = ln(1 + k t)/k.
    const double k = 1000 * 4e-4 / 8e-3;
    CHECK(way("") == near(std::log(1 + k * 0.1) / k, {.relative = 0.02}));
    CHECK(way("level = 0\n") == near(way(""), {.relative = 1e-9}));
}

TEST_CASE("half a block on its plane of symmetry drifts as the whole one: no skin friction on the cut") {
    const sim::Trajectory half = run_text(R"(
name = "half"
length_unit = "mm"
[material.rubber]
youngs_modulus = "1 MPa"
poisson_ratio = 0.3
density = "1000 kg/m^3"
[[body]]
name = "block"
material = "rubber"
geometry = { box = [[0, 0, 0], [20, 10, 20]] }
[mesh]
size = "10 mm"
order = 1
[[fixed]]
name = "symmetry"
plane = { point = [0, 0, 0], normal = [0, 1, 0] }
directions = "normal"
[fluid]
density = "1000 kg/m^3"
drag_tangential = 0.5
current = [1, 0, 0]
[[marker]]
name = "middle"
point = [10, 0, 10]
[program]
duration = "0.1 s"
time_step = "1 ms"
)");
    REQUIRE(half.converged);
    const double drift = half.steps.back().markers[0].position_m.x - half.steps.front().markers[0].position_m.x;
    // m v' = rho/2 c A (U - v)^2 with A that of the four sides along the current: x = U t - ln(1 + k U t)/k.
    const double k = 0.5 * 1000 * 0.5 * 1.6e-3 / 8e-3, t = 0.1;
    CHECK(drift == near(t - std::log(1 + k * t) / k, {.relative = 0.02}));
}

TEST_CASE("a fluid at rest never adds energy to a soft body, with large steps and both integrators") {
    for (const char* integrator : {"bdf2", "energy-conserving"}) {
        for (const double step : {0.002, 0.02}) {
            const sim::Trajectory result = run_text(
                block("density = \"1000 kg/m^3\"\ndrag_normal = 5\ndrag_tangential = 0.5\nlevel = 40\n",
                      fmt::format("duration = \"0.4 s\"\ntime_step = \"{} s\"\nintegrator = \"{}\"\ntolerance = 1e-6\n",
                                  step, integrator) +
                          down,
                      300));
            double largest_kinetic = 0;
            for (const sim::Step& s : result.steps) largest_kinetic = std::max(largest_kinetic, s.kinetic_energy_J);
            double before = 1e300;
            for (const sim::Step& s : result.steps) {
                const double now = s.energy_J + s.kinetic_energy_J;
                CHECK(now < before + 1e-3 * largest_kinetic);
                before = std::min(before, now);
            }
            CHECK(before < -largest_kinetic);
        }
    }
}

TEST_CASE("mistakes in a fluid give one line each") {
    using robot::testing::check_problem;
    check_problem(block("level = 10\n", "steps = 1\n" + down), "density");
    check_problem(block("density = \"0 kg/m^3\"\n", "steps = 1\n" + down), "density: must be above zero");
    check_problem(block("density = \"1 g/cm^3\"\ndrag_normal = -1\n", "steps = 1\n" + down),
                  "drag_normal: -1 is not possible; a coefficient from 0 to 1000");
    check_problem(block("density = \"1 g/cm^3\"\nlevel = 10\n", "steps = 1\n"),
                  "has a level, and nothing says where up is");
    check_problem(block("density = \"1 g/cm^3\"\ndrag = 1\n", "steps = 1\n" + down), "drag: unknown key");
}
