// Sensors, from the robot file to their readings, against closed forms.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/core/near.hpp"
#include "simulation/run/step_record.hpp"
#include "simulation/scene/test_beam.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;
using robot::testing::beam_edge;
using robot::testing::beam_length;
using robot::testing::beam_modulus;
using robot::testing::g;
using robot::testing::run_text;

namespace {

/// A beam of 100 x 10 x 10 mm, clamped at x = 0, with a rigid plate at the other end.
std::string sensed_beam(const std::string& more, const std::string& program = "steps = 2\n") {
    return R"(
name = "beam"
length_unit = "mm"
[material.rubber]
youngs_modulus = "1 MPa"
poisson_ratio = 0
density = "1000 kg/m^3"
[[body]]
name = "beam"
material = "rubber"
geometry = { box = [[0, 0, 0], [100, 10, 10]] }
[mesh]
size = "10 mm"
[[fixed]]
name = "clamp"
plane = { point = [0, 0, 0], normal = [1, 0, 0] }
[[plate]]
name = "end"
plane = { point = [100, 0, 0], normal = [1, 0, 0] }
[[marker]]
name = "tip"
point = [100, 5, 5]
)" + more + "\n[program]\n" +
           program;
}

double reading(const sim::Step& step, const std::string& sensor, const std::string& name) {
    for (const sim::SensorState& s : step.sensors) {
        if (s.name != sensor) continue;
        for (const sim::Reading& r : s.readings)
            if (r.name == name) return r.value;
    }
    FAIL("no reading ", sensor, ".", name);
    return 0;
}

std::string torque(double x_Nm, double y_Nm) {
    return fmt::format("[[load]]\nname = \"turn\"\nplate = \"end\"\ntorque = [\"{} N m\", \"{} N m\", \"0 N m\"]\n",
                       x_Nm, y_Nm);
}

/// A path along x at height z, mm.
std::string along(double from, double to, double step, double z) {
    std::string points;
    for (double x = from; x < to + 0.5 * step; x += step) points += fmt::format("[{}, 5, {}], ", x, z);
    return "points = [" + points + "]\n";
}

/// A soft cube of 20 mm that nothing holds, `low` above the ground.
std::string loose_cube(double low, const std::string& more, const std::string& program) {
    return fmt::format(R"(
name = "cube"
length_unit = "mm"
[material.rubber]
youngs_modulus = "0.2 MPa"
poisson_ratio = 0.4
density = "1000 kg/m^3"
[[body]]
name = "cube"
material = "rubber"
geometry = {{ box = [[0, 0, {}], [20, 20, {}]] }}
[mesh]
size = "10 mm"
order = 1
[[obstacle]]
name = "ground"
plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }}
friction = 0.5
)",
                       low, low + 20) +
           more + "\n[program]\n" + program;
}

}  // namespace

TEST_CASE("a bent beam: its backbone sensor reads the curvature, a strain sensor beside it the strain") {
    const double angle = 0.5, EI = beam_modulus * std::pow(beam_edge, 4) / 12;
    const sim::Trajectory result = run_text(
        sensed_beam(torque(0, -EI * angle / beam_length) + "[[sensor]]\nname = \"spine\"\nkind = \"backbone\"\n" +
                    along(10, 90, 10, 5) + "[[sensor]]\nname = \"skin\"\nkind = \"strain\"\n" + along(10, 90, 5, 10)));
    const sim::Step& end = result.steps.back();
    const double curvature = angle / beam_length;
    CHECK(reading(end, "spine", "bend") == near(0.8 * angle, {.relative = 0.02}));
    CHECK(reading(end, "spine", "curvature") == near(curvature, {.relative = 0.02}));
    CHECK(reading(end, "spine", "curvature_4") == near(curvature, {.relative = 0.03}));
    CHECK(std::abs(reading(end, "spine", "twist")) < 1e-3 * angle);
    CHECK(reading(end, "skin", "strain") == near(-curvature * beam_edge / 2, {.relative = 0.03}));
    CHECK(reading(end, "skin", "length") == near(0.08 * (1 - curvature * beam_edge / 2), {.relative = 0.002}));
    const sim::Step& rest = result.steps.front();
    CHECK(std::abs(reading(rest, "spine", "curvature")) < 1e-9);
    CHECK(std::abs(reading(rest, "skin", "strain")) < 1e-12);
}

TEST_CASE("a twisted bar: its backbone sensor reads Saint-Venant's twist, and no curvature") {
    const double moment = 3e-3, GJ = beam_modulus / 2 * 0.140577 * std::pow(beam_edge, 4);
    const sim::Trajectory result = run_text(
        sensed_beam(torque(moment, 0) + "[[sensor]]\nname = \"spine\"\nkind = \"backbone\"\n" + along(20, 80, 10, 5)),
        {"mesh.size=4 mm"});
    const sim::Step& end = result.steps.back();
    CHECK(reading(end, "spine", "twist") == near(moment * 0.06 / GJ, {.relative = 0.02}));
    CHECK(reading(end, "spine", "twist_rate_3") == near(moment / GJ, {.relative = 0.03}));
    CHECK(std::abs(reading(end, "spine", "bend")) < 0.02 * moment * 0.06 / GJ);
}

TEST_CASE("a sensor line drawn as an arc reads its curvature, without twist") {
    std::string points;
    for (int k = 0; k <= 8; ++k) {
        const double a = 0.1 * k;  // of a circle of 4.5 mm about (50, 5, 9.5)
        points += fmt::format("[{}, 5, {}], ", 50 + 4.5 * std::sin(a), 5 + 4.5 * (1 - std::cos(a)));
    }
    const sim::Trajectory result = run_text(
        sensed_beam("[[sensor]]\nname = \"arc\"\nkind = \"backbone\"\npoints = [" + points + "]\n", "steps = 1\n"));
    const sim::Step& rest = result.steps.front();
    CHECK(reading(rest, "arc", "curvature_4") == near(1 / 4.5e-3, {.relative = 0.002}));
    CHECK(std::abs(reading(rest, "arc", "twist")) < 1e-12);
}

TEST_CASE("a motion sensor reads nothing in free fall and gravity at rest, in its own axes") {
    const auto sensors = [](double low) {
        return fmt::format(R"(
[[sensor]]
name = "straight"
kind = "motion"
point = [10, 10, {0}]
[[sensor]]
name = "turned"
kind = "motion"
point = [10, 10, {0}]
axes = [[0, 0, 1], [1, 0, 0]]
)",
                           low + 15);
    };
    const sim::Trajectory falls = run_text(
        loose_cube(50, sensors(50), "duration = \"0.05 s\"\ntime_step = \"0.005 s\"\ngravity = [0, 0, -9.81]\n"));
    CHECK(reading(falls.steps.front(), "straight", "acceleration_z") == near(g, {.relative = 1e-12}));
    for (std::size_t k = 1; k < falls.steps.size(); ++k) {
        for (const char* axis : {"acceleration_x", "acceleration_y", "acceleration_z"})
            CHECK(std::abs(reading(falls.steps[k], "straight", axis)) < 1e-3 * g);
    }
    const sim::Trajectory rests = run_text(loose_cube(
        0, sensors(0), "duration = \"0.4 s\"\ntime_step = \"0.01 s\"\nmass_damping = 30\ngravity = [0, 0, -9.81]\n"));
    CHECK(reading(rests.steps.back(), "straight", "acceleration_z") == near(g, {.relative = 0.01}));
    CHECK(reading(rests.steps.back(), "turned", "acceleration_x") == near(g, {.relative = 0.01}));
    CHECK(std::abs(reading(rests.steps.back(), "turned", "acceleration_z")) < 0.01 * g);
}

TEST_CASE("a motion sensor on a spinning object reads its rotation and centripetal acceleration") {
    const double w = 5;
    const sim::Trajectory result = run_text(loose_cube(5, R"(
[[object]]
name = "block"
geometry = { box = [[100, 0, 100], [120, 20, 110]] }
mass = "6 g"
angular_velocity = [0, 0, 5]
[[sensor]]
name = "gyro"
kind = "motion"
object = "block"
axes = [[0, 0, 1], [1, 0, 0]]
[[sensor]]
name = "apart"
kind = "distance"
between = ["block", "middle"]
[[marker]]
name = "middle"
point = [10, 10, 10]
)",
                                                       "duration = \"0.1 s\"\ntime_step = \"0.002 s\"\n"));
    const sim::Step& end = result.steps.back();
    CHECK(reading(end, "gyro", "angular_velocity_x") == near(w, {.relative = 0.01}));
    CHECK(std::abs(reading(end, "gyro", "angular_velocity_y")) < 1e-3 * w);
    CHECK(std::abs(reading(end, "gyro", "acceleration_x")) < 1e-2);
    CHECK(reading(end, "apart", "distance") == near(std::sqrt(0.1 * 0.1 + 0.095 * 0.095), {.relative = 1e-3}));
}

TEST_CASE("a contact sensor under a body reads its weight over its area") {
    const sim::Trajectory result = run_text(loose_cube(0, R"(
[[sensor]]
name = "sole"
kind = "contact"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[[sensor]]
name = "top"
kind = "contact"
plane = { point = [0, 0, 20], normal = [0, 0, 1] }
)",
                                                       "steps = 3\ngravity = [0, 0, -9.81]\n"));
    const sim::Step& end = result.steps.back();
    const double weight = 8e-3 * g;
    CHECK(reading(end, "sole", "force_z") == near(weight, {.relative = 0.002}));
    CHECK(reading(end, "sole", "normal_force") == near(weight, {.relative = 0.002}));
    CHECK(reading(end, "sole", "area") == near(4e-4, {.relative = 1e-9}));
    CHECK(reading(end, "sole", "pressure") == near(weight / 4e-4, {.relative = 0.002}));
    CHECK(reading(end, "top", "force_z") == 0);
    CHECK(reading(end, "top", "area") == 0);
}

TEST_CASE("sensors of cables and chambers read the reported values, and are stored with the step") {
    const sim::Trajectory result = run_text(sensed_beam(R"(
[[cable]]
name = "flexor"
points = [[90, 5, 8], [10, 5, 8]]
target = { shortening = "2 mm" }
[[chamber]]
name = "air"
geometry = { box = [[40, 3, 3], [60, 7, 7]] }
target = { pressure = "5 kPa" }
[[sensor]]
name = "pull"
kind = "tension"
cable = "flexor"
[[sensor]]
name = "gauge"
kind = "pressure"
chamber = "air"
[[sensor]]
name = "flow"
kind = "volume"
chamber = "air"
)"));
    const sim::Step& end = result.steps.back();
    CHECK(reading(end, "pull", "tension") == end.cables[0].tension_N);
    CHECK(end.cables[0].tension_N > 0);
    CHECK(reading(end, "gauge", "pressure") == near(5e3, {.relative = 1e-9}));
    CHECK(reading(end, "flow", "volume") == end.chambers[0].volume_m3);
    const auto read = sim::step_from_bytes(sim::step_bytes(end, {}), end.positions.size());
    REQUIRE(read);
    CHECK(reading(read->step, "pull", "tension") == end.cables[0].tension_N);
    CHECK(read->step.sensors.size() == 3);
}

TEST_CASE("mistakes in sensors give one line each") {
    using robot::testing::check_problem;
    const auto sensor = [](const std::string& keys) { return sensed_beam("[[sensor]]\nname = \"it\"\n" + keys); };
    check_problem(sensor("kind = \"strane\"\n"), "did you mean \"strain\"");
    check_problem(sensor("kind = \"strain\"\npoints = [[1, 5, 5]]\n"), "points: needs at least 2 points");
    check_problem(sensor("kind = \"backbone\"\npoints = [[1, 5, 5], [50, 5, 5]]\n"), "points: needs at least 3 points");
    check_problem(sensor("kind = \"strain\"\npoints = [[1, 5, 5], [150, 5, 5]]\n"),
                  "sensor \"it\": the point (150, 5, 5) lies outside every body, by 50 mm");
    check_problem(sensor("kind = \"tension\"\ncable = \"flexor\"\n"), "cable: there is no cable \"flexor\"");
    check_problem(sensor("kind = \"pressure\"\n"), "chamber");
    check_problem(sensor("kind = \"distance\"\nbetween = [\"tip\", \"ball\"]\n"),
                  "between: there is no marker and no object \"ball\"");
    check_problem(sensor("kind = \"distance\"\n"), "takes one of points (two) and between");
    check_problem(sensor("kind = \"motion\"\nmarker = \"tip\"\npoint = [1, 5, 5]\n"),
                  "takes one of point, marker and object");
    check_problem(sensor("kind = \"motion\"\nmarker = \"tip\"\naxes = [[1, 0, 0], [1, 1, 0]]\n"),
                  "axes: must be two directions at right angles");
    check_problem(sensor("kind = \"contact\"\nbox = [[40, 4, 4], [60, 6, 6]]\n"), "catches no triangle of the surface");
}
