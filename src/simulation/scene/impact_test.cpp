// Falling, bouncing and coming to rest, with every time integration scheme. PLIANT_BOUNCING_STEPS makes the run over
// which energy is observed longer (default 600).
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <string_view>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;
using robot::testing::g;
using robot::testing::run_text;

namespace {

/// A small clamped cube, which takes no part.
const std::string post = R"(
name = "impact"
length_unit = "mm"
[material.rubber]
youngs_modulus = "1 MPa"
poisson_ratio = 0.45
[[body]]
name = "post"
material = "rubber"
geometry = { box = [[-300, 0, 10], [-290, 10, 20]] }
[mesh]
size = "10 mm"
order = 1
[[fixed]]
name = "clamp"
plane = { point = [0, 0, 10], normal = [0, 0, 1] }
)";

/// The post, a ground z = 0, and an object.
std::string impact_world(const std::string& object, const std::string& program, double friction = 0) {
    return post + fmt::format(R"([contact]
distance = "0.4 mm"
[[obstacle]]
name = "ground"
plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }}
friction = {}
[[object]]
{}
[program]
gravity = [0, 0, -9.81]
{})",
                              friction, object, program);
}

double height(const sim::Step& step) {
    return step.objects[0].position_m.z;
}

double energy(const sim::Step& step) {
    return step.energy_J + step.kinetic_energy_J;
}

const std::string ball =
    "name = \"ball\"\ngeometry = { sphere = { center = [0, 0, 30], radius = 10 } }\ndensity = \"1000 kg/m^3\"\n";

/// Height reached after falling from `fall` and rebounding with the landing speed, with a drag of `c` times the
/// momentum.
double rebound(double fall, double c) {
    const double dt = 1e-6;
    double z = fall, v = 0;
    while (z > 0) {
        v -= (g + c * v) * dt;
        z += v * dt;
    }
    for (v = -v; v > 0; z += v * dt) v -= (g + c * v) * dt;
    return z;
}

}  // namespace

TEST_CASE("a dropped ball bounces as high as its damping allows, with error-controlled steps") {
    for (const double damping : {0.0, 3.0}) {
        const sim::Trajectory result = run_text(
            impact_world(ball, fmt::format("duration = \"0.2 s\"\ntime_step = \"2 ms\"\ntime_tolerance = \"0.2 um\"\n"
                                           "integrator = \"energy-conserving\"\nmass_damping = {}\n",
                                           damping)));
        const auto lowest = std::min_element(result.steps.begin(), result.steps.begin() + 45,  // it lands once by then
                                             [](const auto& a, const auto& b) { return height(a) < height(b); });
        const auto highest = std::max_element(lowest, result.steps.end(),
                                              [](const auto& a, const auto& b) { return height(a) < height(b); });
        const double found = height(*highest) - 10e-3, wanted = rebound(20e-3, damping);
        MESSAGE("damping ", damping, " /s: got up to ", 1e3 * found, " mm, wanted ", 1e3 * wanted);
        CHECK(found == near(wanted, {.relative = 0.03}));
    }
}

TEST_CASE("a bouncing ball comes to rest and stays there") {
    const sim::Trajectory result =
        run_text(impact_world(ball,
                              "duration = \"0.8 s\"\ntime_step = \"2 ms\"\nintegrator = \"energy-conserving\"\n"
                              "mass_damping = 5\n"));
    const std::size_t n = result.steps.size();
    const double fallen = 4.19e-3 * g * 20e-3;
    for (std::size_t k = n - 100; k < n; ++k) {
        CHECK(std::fabs(height(result.steps[k]) - height(result.steps[n - 1])) < 1e-6);
        CHECK(result.steps[k].kinetic_energy_J < 1e-5 * fallen);
        CHECK(result.steps[k].objects[0].force_N.z == near(4.19e-3 * g, {.relative = 0.02}));
    }
}

TEST_CASE("nothing rebounds higher than it fell, and a collision adds no energy, with any integrator") {
    const std::string block = "name = \"block\"\ngeometry = { box = [[0, 0, 20], [20, 20, 40]] }\nmass = \"100 g\"\n";
    for (const char* integrator : {"bdf2", "energy-conserving"}) {
        const std::string program =
            fmt::format("duration = \"0.3 s\"\ntime_step = \"2 ms\"\nintegrator = \"{}\"\n", integrator);
        const sim::Trajectory fall = run_text(impact_world(block, program));
        const double fallen = 0.1 * g * 20e-3;
        double after_impact = 0;
        bool landed = false;
        for (const sim::Step& step : fall.steps) {
            CHECK(energy(step) < energy(fall.steps[0]) + 0.01 * fallen);
            landed = landed || norm(step.objects[0].force_N) > 0;
            if (landed) after_impact = std::max(after_impact, height(step));
        }
        CHECK(landed);
        CHECK(after_impact < 29e-3);

        // Onto another that stands on the ground already, so that something is in contact all the time.
        const sim::Trajectory onto = run_text(
            impact_world(block + "[[object]]\nname = \"step\"\ngeometry = { box = [[-5, -5, 0.5], [25, 25, 15]] }\n"
                                 "mass = \"300 g\"\n",
                         program));
        for (const sim::Step& step : onto.steps)
            CHECK(energy(step) < energy(onto.steps[0]) + 0.02 * 0.1 * g * 5e-3 + 0.01 * 0.3 * g * 0.5e-3);

        const sim::Trajectory collision = run_text(impact_world(
            "name = \"a\"\ngeometry = { box = [[0, 0, 500], [20, 20, 520]] }\nmass = \"100 g\"\nvelocity = [1, 0, 0]\n"
            "[[object]]\nname = \"b\"\ngeometry = { box = [[25, 0, 500], [45, 20, 520]] }\nmass = \"300 g\"\n",
            fmt::format("duration = \"0.03 s\"\ntime_step = \"1 ms\"\nintegrator = \"{}\"\n", integrator)));
        // Both fall alike: what is left is the motion along x.
        const auto speed = [&](std::size_t object) {
            const auto& last = collision.steps.back().objects[object].position_m;
            return (last.x - collision.steps[collision.steps.size() - 2].objects[object].position_m.x) / 1e-3;
        };
        const double momentum = 0.1 * speed(0) + 0.3 * speed(1);
        CHECK(momentum == near(0.1, {.relative = 1e-6}));
        CHECK(speed(1) > 0.2);
        CHECK(0.5 * (0.1 * speed(0) * speed(0) + 0.3 * speed(1) * speed(1)) < 0.0505);
    }
}

TEST_CASE("a collision is followed with any tolerance in time, also where nothing but inertia balances the contact") {
    for (const char* tolerance : {"0.002 mm", "0.001 mm", "0.0005 mm"}) {
        std::string text = impact_world(
            "name = \"a\"\ngeometry = { box = [[0, 0, 500], [20, 20, 520]] }\nmass = \"100 g\"\nvelocity = [1, 0, 0]\n"
            "[[object]]\nname = \"b\"\ngeometry = { box = [[25, 0, 500], [45, 20, 520]] }\nmass = \"300 g\"\n",
            fmt::format("duration = \"0.02 s\"\ntime_step = \"1 ms\"\ntime_tolerance = \"{}\"\n", tolerance));
        text = test::replaced(text, "gravity = [0, 0, -9.81]\n", "");
        text = test::replaced(text, "distance = \"0.4 mm\"\n", "");
        const sim::Trajectory result = run_text(text);
        REQUIRE_MESSAGE(result.converged, result.message);
        CHECK(result.steps.back().kinetic_energy_J < 0.05 * (1 + 1e-3));
        CHECK(result.steps.back().kinetic_energy_J > 0.5 * 0.05 * 0.25);  // what moves with the centre of mass remains
    }
}

TEST_CASE("energy never grows while a block bounces, tumbles and slides with energy-conserving steps") {
    const char* wanted = std::getenv("PLIANT_BOUNCING_STEPS");
    const std::size_t steps = wanted != nullptr ? std::strtoul(wanted, nullptr, 10) : 600;
    const sim::Trajectory result = run_text(impact_world(
        "name = \"block\"\ngeometry = { box = [[0, 0, 30], [20, 14, 40]] }\ndensity = \"1000 kg/m^3\"\n"
        "velocity = [0.5, 0.1, 0]\nangular_velocity = [3, -8, 2]\n",
        fmt::format("duration = \"{} s\"\ntime_step = \"1 ms\"\nintegrator = \"energy-conserving\"\ntolerance = 1e-6\n",
                    1e-3 * static_cast<double>(steps)),
        0.3));
    const double scale = 2.8e-3 * g * 30e-3;
    double lowest = energy(result.steps[0]);
    for (std::size_t k = 1; k < result.steps.size(); ++k) {
        double before = energy(result.steps[k - 1]);
        for (std::size_t j = k > 20 ? k - 20 : 0; j < k; ++j) before = std::max(before, energy(result.steps[j]));
        CHECK(energy(result.steps[k]) < before + 1e-3 * scale);
        lowest = std::min(lowest, energy(result.steps[k]));
    }
    CHECK(energy(result.steps.back()) < energy(result.steps[0]) - 0.5 * scale);
    CHECK(energy(result.steps.back()) < lowest + 2e-3 * scale);
}

TEST_CASE("a freely spinning object keeps its energy, and its centre falls on a parabola") {
    const sim::Trajectory result = run_text(impact_world(
        "name = \"top\"\ngeometry = { box = [[0, 0, 600], [20, 14, 610]] }\ndensity = \"1000 kg/m^3\"\n"
        "velocity = [0, 0, 1]\nangular_velocity = [20, 30, 5]\n",
        "duration = \"0.3 s\"\ntime_step = \"2 ms\"\nintegrator = \"energy-conserving\"\ntolerance = 1e-7\n"));
    const double scale = result.steps[0].kinetic_energy_J;
    for (const sim::Step& step : result.steps)
        CHECK(energy(step) == near(energy(result.steps[0]), {.absolute = 1e-4 * scale}));
    const double T = 0.3;
    CHECK(height(result.steps.back()) == near(605e-3 + T - 0.5 * g * T * T, {.absolute = 1e-6}));
}

TEST_CASE("what spins or tumbles freely follows its free motion in steps of any length") {
    const auto run = [](const std::string& spin, const std::string& step, const std::string& more = "") {
        return run_text(
            impact_world("name = \"top\"\ngeometry = { box = [[-5, -10, 600], [5, 10, 640]] }\nmass = \"100 "
                         "g\"\nvelocity = [0.3, 0, 1]\n"
                         "angular_velocity = " +
                             spin + "\n",
                         "duration = \"0.3 s\"\ntolerance = 1e-8\ntime_step = \"" + step + "\"\n" + more));
    };
    const auto spin_energy = [](const sim::Trajectory& result) {
        const double v = 1 - 0.3 * g;
        return result.steps.back().kinetic_energy_J - 0.5 * 0.1 * (0.3 * 0.3 + v * v);
    };
    const sim::Trajectory top = run("[0, 0, 30]", "10 ms");
    const auto& q = top.steps.back().objects[0].rotation;
    CHECK(std::remainder(2 * std::atan2(q[3], q[0]) - 9, 2 * std::numbers::pi) == near(0, {.absolute = 1e-5}));
    CHECK(spin_energy(top) == near(0.5 * 0.1 / 12 * (0.01 * 0.01 + 0.02 * 0.02) * 900, {.relative = 1e-5}));
    CHECK(top.warnings.empty());
    const sim::Trajectory fine = run("[2, 25, 3]", "2.5 ms");
    for (const char* more : {"", "time_tolerance = \"1 um\"\n"}) {
        const sim::Trajectory coarse = run("[2, 25, 3]", "15 ms", more);
        for (std::size_t k = 0; k < 4; ++k)
            CHECK(coarse.steps.back().objects[0].rotation[k] ==
                  near(fine.steps.back().objects[0].rotation[k], {.absolute = 1e-4}));
        CHECK(spin_energy(coarse) == near(spin_energy(fine), {.relative = 1e-4}));
    }
}

TEST_CASE("a torque turns an object as fast as it should in short steps; of long ones a warning tells") {
    constexpr double torque_Nm = 0.5e-3, inertia_kg_m2 = 0.1 * 0.02 * 0.02 / 6, speed = torque_Nm / inertia_kg_m2;
    const auto end = [&](const char* step) {
        std::string text = impact_world(
            "name = \"wheel\"\ngeometry = { box = [[0, 0, 100], [20, 20, 120]] }\nmass = \"100 g\"\n"
            "[[load]]\nname = \"drive\"\nobject = \"wheel\"\ntorque = [\"0 N mm\", \"0 N mm\", \"0.5 N mm\"]\n",
            fmt::format("duration = \"1 s\"\ntolerance = 1e-8\ntime_step = \"{}\"\n"
                        "[[program.key]]\ntime = \"0.001 ms\"\ndrive = 1\n",
                        step));
        return run_text(test::replaced(text, "gravity = [0, 0, -9.81]\n", ""));
    };
    const sim::Trajectory fine = end("1 ms"), coarse = end("10 ms");
    const double wanted_J = 0.5 * inertia_kg_m2 * speed * speed;
    CHECK(fine.steps.back().kinetic_energy_J == near(wanted_J, {.relative = 0.02}));
    CHECK(fine.warnings.empty());
    CHECK(coarse.steps.back().kinetic_energy_J < wanted_J);
    REQUIRE(coarse.warnings.size() == 1);
    CHECK(coarse.warnings[0].find("object \"wheel\" turns by up to 0.") == 0);
}

TEST_CASE("a spring that swings an object by a large angle loses energy from swing to swing, in steps of any length") {
    for (const double per_swing : {20.0, 50.0}) {
        constexpr double inertia_kg_m2 = 0.1 * 0.02 * 0.02 / 6, stiffness_Nm = 15e-3, amplitude = 2;
        const double frequency = std::sqrt(stiffness_Nm / inertia_kg_m2), swing_s = 2 * std::numbers::pi / frequency;
        const std::string text = impact_world(
            fmt::format("name = \"wheel\"\ngeometry = {{ box = [[0, 0, 100], [20, 20, 140]] }}\nmass = \"100 g\"\n"
                        "angular_velocity = [0, 0, {}]\n[[joint]]\nname = \"spring\"\nkind = \"hinge\"\n"
                        "between = [\"world\", \"wheel\"]\npoint = [10, 10, 120]\naxis = [0, 0, 1]\n"
                        "stiffness = \"15 N mm/rad\"\n",
                        amplitude * frequency),
            fmt::format("duration = \"{} s\"\ntime_step = \"{} s\"\n", 5 * swing_s, swing_s / per_swing));
        const sim::Trajectory result = run_text(test::replaced(text, "gravity = [0, 0, -9.81]\n", ""));
        REQUIRE_MESSAGE(result.converged, result.message);
        // Within a swing BDF2 may add energy, the less the shorter the steps are; from swing to swing it takes some
        // away.
        const auto steps = static_cast<std::size_t>(per_swing);
        double largest_J = 0.5 * stiffness_Nm * amplitude * amplitude;
        for (std::size_t swing = 0; swing < 5; ++swing) {
            double now_J = 0;
            for (std::size_t k = swing * steps + 1; k <= (swing + 1) * steps; ++k)
                now_J = std::max(now_J, energy(result.steps[k]));
            CHECK(now_J < (swing == 0 ? 1 + 6 / per_swing : 1) * largest_J);
            largest_J = now_J;
        }
    }
}

TEST_CASE("a frictionless table does not turn or shift what lands on it") {
    std::string text =
        impact_world("name = \"cube\"\ngeometry = { box = [[0, 0, 0.5], [20, 20, 20.5]] }\nmass = \"50 g\"\n",
                     "duration = \"1 s\"\ntime_step = \"10 ms\"\n");
    // Its diagonals lie along those of the cube.
    text = test::replaced(text, "plane = { point = [0, 0, 0], normal = [0, 0, 1] }\nfriction",
                          "geometry = { box = [[-40, -40, -10], [60, 60, 0]] }\nfriction");
    const sim::Trajectory result = run_text(text);
    const auto& cube = result.steps.back().objects[0];
    CHECK(2 * std::atan2(cube.rotation[3], cube.rotation[0]) == near(0, {.absolute = 1e-5}));
    CHECK(cube.position_m.x == near(10e-3, {.absolute = 1e-7}));
    CHECK(cube.position_m.y == near(10e-3, {.absolute = 1e-7}));
}

TEST_CASE("a block that slides just above the flat face of an object goes straight on at its height") {
    std::string text = impact_world(
        "name = \"table\"\ngeometry = { box = [[-50, -50, 0.05], [100, 50, 10]] }\nmass = \"10 kg\"\n"
        "[[joint]]\nname = \"held\"\nkind = \"glue\"\nbetween = [\"world\", \"table\"]\npoint = [25, 0, 5]\n"
        "[[object]]\nname = \"block\"\ngeometry = { box = [[-20, -10, 10.05], [0, 10, 30.05]] }\nmass = \"50 g\"\n"
        "velocity = [0.2, 0, 0]\n",
        "duration = \"0.2 s\"\ntime_step = \"2 ms\"\n");
    const sim::Trajectory result = run_text(text);
    REQUIRE_MESSAGE(result.converged, result.message);
    const auto& block = result.steps.back().objects[1];
    CHECK(block.position_m.x == near(30e-3, {.absolute = 0.2e-3}));
    CHECK(block.position_m.y == near(0, {.absolute = 0.02e-3}));
    CHECK(block.position_m.z == near(20e-3, {.absolute = 0.2e-3}));
    CHECK(block.rotation[0] > 0.9999);
}

TEST_CASE("a block on the diagonal of a flat face sticks as on any other place") {
    // A slope of 20 degrees along the diagonal of the table, over which the corners of the cube lie.
    constexpr double slope = 20 * std::numbers::pi / 180;
    std::string text =
        impact_world("name = \"cube\"\ngeometry = { box = [[0, 0, 0.02], [20, 20, 20.02]] }\nmass = \"50 g\"\n",
                     "duration = \"0.2 s\"\ntime_step = \"5 ms\"\n", 0.6);
    text = test::replaced(text, "plane = { point = [0, 0, 0], normal = [0, 0, 1] }",
                          "geometry = { box = [[-40, -40, -10], [60, 60, 0]] }");
    text = test::replaced(
        text, "gravity = [0, 0, -9.81]",
        fmt::format("gravity = [{0}, {0}, {1}]", g * std::sin(slope) / std::numbers::sqrt2, -g * std::cos(slope)));
    const sim::Trajectory result = run_text(text);
    REQUIRE_MESSAGE(result.converged, result.message);
    const auto& cube = result.steps.back().objects[0];
    CHECK(cube.position_m.x == near(10e-3, {.absolute = 20e-6}));
    CHECK(cube.position_m.y == near(10e-3, {.absolute = 20e-6}));
}

TEST_CASE("a block that slides into a wall of the obstacle on which it slides does not come back faster") {
    for (const char* integrator : {"bdf2", "energy-conserving"}) {
        std::string text = impact_world(
            "name = \"block\"\ngeometry = { box = [[0, -10, 0.1], [20, 10, 20.1]] }\nmass = \"50 g\"\n"
            "velocity = [1, 0, 0]\n",
            fmt::format("duration = \"0.2 s\"\ntime_step = \"10 ms\"\nintegrator = \"{}\"\n", integrator));
        text = test::replaced(text, "plane = { point = [0, 0, 0], normal = [0, 0, 1] }",
                              "geometry = { union = [{ box = [[-50, -50, -10], [150, 50, 0]] },"
                              " { box = [[100, -50, -10], [150, 50, 50]] }] }");
        const sim::Trajectory result = run_text(text);
        REQUIRE_MESSAGE(result.converged, result.message);
        double most_J = 0;
        for (const sim::Step& step : result.steps) most_J = std::max(most_J, step.kinetic_energy_J);
        CHECK(most_J < 1.01 * 0.5 * 0.05);
        CHECK(result.steps.back().kinetic_energy_J < 0.1 * 0.5 * 0.05);
    }
}

TEST_CASE("a ball that rolls by half a radian a step rolls on") {
    const sim::Trajectory result = run_text(
        impact_world("name = \"ball\"\ngeometry = { sphere = { center = [0, 0, 10], radius = 10 } }\nmass = \"4 g\"\n"
                     "velocity = [0.5, 0, 0]\nangular_velocity = [0, 50, 0]\n",
                     "duration = \"0.6 s\"\ntime_step = \"10 ms\"\n", 1));
    CHECK(result.steps.back().objects[0].position_m.x == near(0.3, {.relative = 0.02}));
    REQUIRE(result.warnings.size() == 1);
    CHECK(result.warnings[0].find("object \"ball\" turns by up to 0.5") == 0);
}

TEST_CASE("an object that rotates about a principal axis keeps its angular velocity, whatever the stiffest body is") {
    for (const char* integrator : {"bdf2", "energy-conserving"}) {
        for (const char* modulus : {"1 kPa", "1 MPa", "1 GPa"}) {
            std::string text = impact_world(
                "name = \"top\"\ngeometry = { box = [[-5, -10, 600], [5, 10, 640]] }\nmass = \"100 g\"\n"
                "angular_velocity = [0, 0, 10]\n",
                fmt::format("duration = \"0.3 s\"\ntime_step = \"5 ms\"\nintegrator = \"{}\"\n", integrator));
            text = test::replaced(text, "youngs_modulus = \"1 MPa\"", fmt::format("youngs_modulus = \"{}\"", modulus));
            text = test::replaced(text, "gravity = [0, 0, -9.81]\n", "");
            const sim::Trajectory result = run_text(text);
            const sim::Step& last = result.steps.back();
            const bool conserves = std::string_view(integrator) == "energy-conserving";
            const auto& q = last.objects[0].rotation;
            CHECK(2 * std::atan2(q[3], q[0]) == near(3, {.relative = conserves ? 1e-3 : 2e-4}));
            CHECK(last.kinetic_energy_J ==
                  near(0.5 * 0.1 / 12 * (0.01 * 0.01 + 0.02 * 0.02) * 100, {.relative = conserves ? 1e-3 : 2e-4}));
        }
    }
}

TEST_CASE("mistakes in time steps give one line each") {
    using robot::testing::check_problem;
    const auto text = [](const std::string& program) { return impact_world(ball, program); };
    check_problem(text("steps = 2\nintegrator = \"energy-conserving\"\n"),
                  "integrator: has no meaning without time_step");
    check_problem(text("steps = 2\ntime_tolerance = \"1 um\"\n"), "time_tolerance: has no meaning without time_step");
    check_problem(text("time_step = \"1 ms\"\ntime_tolerance = \"0 um\"\n"), "time_tolerance: must be above zero");
    check_problem(text("time_step = \"1 ms\"\ntime_tolerance = 1e-6\n"), "time_tolerance: 1e-06 has no unit");
    check_problem(text("time_step = \"1 ms\"\nintegrator = \"energy-conservin\"\n"),
                  "did you mean \"energy-conserving\"");
    check_problem(impact_world(ball + "[[cable]]\nname = \"c\"\npoints = [[-295, 5, 12], [-295, 5, 18]]\n"
                                      "target = { length_ratio = 0.9 }\n",
                               "time_step = \"1 ms\"\nintegrator = \"energy-conserving\"\n"),
                  "cable \"c\" is driven by its length");
}

namespace {

/// A weight of 100 g that hangs on a cable with 50 mm of slack.
sim::Trajectory fall_into_slack(const std::string& program) {
    return run_text(post + R"([[object]]
name = "weight"
geometry = { box = [[-5, -5, -5], [5, 5, 5]] }
mass = "100 g"
[[cable]]
name = "rope"
points = [[0, 0, 100], [0, 0, 5]]
anchor = "first"
target = { shortening = "-50 mm" }
[program]
gravity = [0, 0, -9.81]
duration = "0.2 s"
key = [{ time = "0 s", rope = "-50 mm" }]
)" + program);
}

constexpr double fall_energy_J = 0.1 * g * 0.05;

}  // namespace

TEST_CASE("a weight that falls into a slack cable is caught and does not rise again, whatever the time step") {
    for (const double step_ms : {5.0, 3.0, 2.5, 2.0, 1.2, 1.0, 0.8, 0.5}) {
        CAPTURE(step_ms);
        const sim::Trajectory result = fall_into_slack(fmt::format("time_step = \"{} ms\"", step_ms));
        REQUIRE(result.converged);
        bool is_caught = false;
        double before = energy(result.steps.front());
        for (const sim::Step& step : result.steps) {
            CHECK(energy(step) < before + 1e-3 * fall_energy_J);
            before = energy(step);
            is_caught = is_caught || height(step) < -0.0495;
            if (is_caught) CHECK(height(step) < -0.0495);
        }
        CHECK(is_caught);
        CHECK(height(result.steps.back()) == near(-0.05, {.absolute = 1e-5}));
        CHECK(result.steps.back().cables[0].tension_N == near(0.1 * g, {.relative = 0.01}));
    }
}

TEST_CASE("a weight that a slack cable throws back, with error-controlled steps, has no more energy than before") {
    const sim::Trajectory result = fall_into_slack("time_step = \"2 ms\"\ntime_tolerance = \"0.01 mm\"");
    REQUIRE(result.converged);
    for (const sim::Step& step : result.steps)
        CHECK(energy(step) < energy(result.steps.front()) + 0.01 * fall_energy_J);
}
