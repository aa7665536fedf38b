// Joints, from the robot file to their motion, against closed forms.
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "geometry/files/tet_writer.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/scene/test_run.hpp"
#include "simulation/stepper/state_file.hpp"

using namespace pliant;
using robot::testing::g;

namespace {

constexpr double pi = std::numbers::pi;

/// A small clamped cube, which takes no part, and what the test adds.
std::string jointed_world(const std::string& more, const std::string& program) {
    return R"(
name = "jointed"
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
[contact]
distance = "0.2 mm"
)" + more + "\n[program]\ntolerance = 1e-6\n" +
           program;
}

std::string in_time(double duration_s, double step_s, bool heavy = true) {
    return fmt::format("duration = \"{} s\"\ntime_step = \"{} s\"\ngravity = [0, 0, {}]\n", duration_s, step_s,
                       heavy ? -g : 0);
}
std::string at_rest() {
    return fmt::format("steps = 2\ngravity = [0, 0, {}]\n", -g);
}

struct JointedRun {
    robot::testing::Built built;
    sim::Trajectory result;
    [[nodiscard]] const sim::Step& last() const { return result.steps.back(); }
    [[nodiscard]] const sim::JointState& joint(std::size_t k = 0) const { return last().joints.at(k); }
};

JointedRun run_jointed(const std::string& text) {
    auto built = robot::testing::build(robot::parse_robot(text, "jointed.toml"));
    sim::Trajectory result = robot::testing::run_to_the_end(built);
    return {std::move(built), std::move(result)};
}

/// A bar of 100 x 10 x 10 mm and 10 g that hangs from the origin, or lies along x from there.
std::string bar(const std::string& name, bool hangs, double from_mm = 0, const std::string& more = "") {
    const std::string box = hangs ? fmt::format("[[-5, -5, {}], [5, 5, {}]]", -from_mm - 100, -from_mm)
                                  : fmt::format("[[{}, -5, -5], [{}, 5, 5]]", from_mm, from_mm + 100);
    return fmt::format("[[object]]\nname = \"{}\"\ngeometry = {{ box = {} }}\ndensity = \"1000 kg/m^3\"\n{}\n", name,
                       box, more);
}
constexpr double bar_kg = 0.01, bar_m = 0.1;
constexpr double bar_inertia = bar_kg * (0.1 * 0.1 + 0.01 * 0.01) / 12;

std::string joint(const std::string& kind, const std::string& first, const std::string& second, double x_mm,
                  double z_mm, const std::string& more = "") {
    return fmt::format(
        "[[joint]]\nname = \"{0}\"\nkind = \"{0}\"\nbetween = [\"{1}\", \"{2}\"]\npoint = [{3}, 0, {4}]\n{5}\n", kind,
        first, second, x_mm, z_mm, more);
}
const std::string about_y = "axis = [0, 1, 0]";

}  // namespace

TEST_CASE("a bar on a hinge swings with the period of a physical pendulum") {
    const double inertia = bar_inertia + bar_kg * bar_m * bar_m / 4;
    const double period = 2 * pi * std::sqrt(inertia / (bar_kg * g * bar_m / 2));
    const double spin = 0.5;  // 0.04 rad at most
    const JointedRun r = run_jointed(jointed_world(
        bar("bar", true, 0,
            fmt::format("angular_velocity = [0, {}, 0]\nvelocity = [{}, 0, 0]", spin, -spin * bar_m / 2)) +
            joint("hinge", "world", "bar", 0, 0, about_y),
        in_time(2.1 * period, period / 200)));
    std::vector<double> crossings;
    const auto angle = [&](std::size_t k) { return r.result.steps[k].joints[0].coordinate; };
    for (std::size_t k = 2; k < r.result.steps.size(); ++k) {
        if ((angle(k) > 0) == (angle(k - 1) > 0)) continue;
        const double share = angle(k - 1) / (angle(k - 1) - angle(k));
        crossings.push_back(r.result.steps[k - 1].time + share * period / 200);
    }
    REQUIRE(crossings.size() >= 4);
    MESSAGE("period ", crossings[3] / 2, " s, wanted ", period);
    CHECK(crossings[3] / 2 == near(period, {.relative = 0.01}));
    CHECK(r.joint().force_N.z == near(bar_kg * g, {.relative = 0.02}));
}

TEST_CASE("a double pendulum keeps its energy") {
    const JointedRun r = run_jointed(
        jointed_world(bar("upper", false) + bar("lower", false, 100) + joint("hinge", "world", "upper", 0, 0, about_y) +
                          "[[joint]]\nname = \"elbow\"\nkind = \"hinge\"\nbetween = [\"upper\", \"lower\"]\n"
                          "point = [100, 0, 0]\naxis = [0, 1, 0]\n",
                      in_time(0.3, 0.0005)));
    const auto energy = [&](std::size_t k) { return r.result.steps[k].energy_J + r.result.steps[k].kinetic_energy_J; };
    const double scale = 2 * bar_kg * g * bar_m;
    double most = 0, off = 0;
    for (std::size_t k = 1; k < r.result.steps.size(); ++k) {
        most = std::max(most, r.result.steps[k].kinetic_energy_J);
        off = std::max(off, std::fabs(energy(k) - energy(0)));
    }
    MESSAGE("energy off by ", off / scale, " of the weight's, of which ", most / scale, " was in motion");
    CHECK(most > 0.5 * scale);
    CHECK(off < 0.01 * scale);
}

TEST_CASE("a motor that holds a bar level reports the bar's weight and its torque") {
    const JointedRun r = run_jointed(jointed_world(
        bar("bar", false) + joint("motor", "world", "bar", 0, 0, about_y + "\nangle = \"0 deg\""), at_rest()));
    CHECK(r.joint().force_N.z == near(bar_kg * g, {.relative = 1e-3}));
    // About y by the right hand a torque below zero lifts what lies along x.
    CHECK(r.joint().torque_Nm.y == near(-bar_kg * g * bar_m / 2, {.relative = 2e-3}));
    CHECK(r.joint().effort == near(r.joint().torque_Nm.y, {.relative = 1e-3}));
    CHECK(std::fabs(r.joint().coordinate) < 1e-3);
}

TEST_CASE("a hinge with a spring turns until its torque balances the weight, and a limit stops it") {
    const double stiffness = 0.02;
    const std::string springy = about_y + fmt::format("\nstiffness = \"{} N*m/rad\"", stiffness);
    const JointedRun r =
        run_jointed(jointed_world(bar("bar", false) + joint("hinge", "world", "bar", 0, 0, springy), at_rest()));
    const double angle = r.joint().coordinate;
    CHECK(stiffness * angle == near(bar_kg * g * bar_m / 2 * std::cos(angle), {.relative = 2e-3}));
    CHECK(angle > 0.2);
    const JointedRun stopped = run_jointed(jointed_world(
        bar("bar", false) + joint("hinge", "world", "bar", 0, 0, about_y + "\nlimits = [-10, 5]"), at_rest()));
    CHECK(stopped.joint().coordinate == near(5 * pi / 180, {.absolute = 1e-3}));
}

TEST_CASE("a soft body on a free hinge or ball swings to where it hangs in one static step, or to its stop") {
    const auto swung = [](const std::string& kind, const std::string& more) {
        const std::string body =
            "[material.heavy]\nyoungs_modulus = \"1 MPa\"\npoisson_ratio = 0.3\ndensity = \"1000 kg/m^3\"\n"
            "[[body]]\nname = \"flap\"\nmaterial = \"heavy\"\ngeometry = { box = [[0, -5, -5], [100, 5, 5]] }\n";
        std::string text = jointed_world(
            body + joint(kind, "world", "flap", 0, 0, more) + "[[marker]]\nname = \"tip\"\npoint = [95, 0, 0]\n",
            fmt::format("steps = 1\ngravity = [0, 0, {}]\n", -g));
        // Nothing touches, and looking for it takes most of the time.
        const std::string contact = "[contact]\ndistance = \"0.2 mm\"\n";
        text.erase(text.find(contact), contact.size());
        return run_jointed(text);
    };
    const JointedRun hinge = swung("hinge", about_y), ball = swung("ball", "");
    for (const JointedRun* run : {&hinge, &ball}) {
        const Vec3 tip = run->last().markers.at(0).position_m;
        CHECK(std::hypot(tip.x, tip.y) < 2e-3);
        CHECK(tip.z == near(-0.095, {.relative = 0.02}));
    }
    const JointedRun stopped = swung("hinge", about_y + "\nlimits = [-5, 5]");
    CHECK(std::abs(stopped.joint().coordinate) == near(5 * pi / 180, {.relative = 0.01}));
}

TEST_CASE("a bar that falls against the limit of its hinge gains no energy, and comes to rest there") {
    for (const char* integrator : {"bdf2", "energy-conserving"}) {
        CAPTURE(std::string(integrator));
        const JointedRun r = run_jointed(
            jointed_world(bar("bar", false) + joint("hinge", "world", "bar", 0, 0, about_y + "\nlimits = [-10, 40]"),
                          in_time(0.5, 0.004) + fmt::format("integrator = \"{}\"\n", integrator)));
        const double limit = 40 * pi / 180, fallen_J = bar_kg * g * bar_m / 2 * std::sin(limit);
        const auto energy = [](const sim::Step& step) { return step.energy_J + step.kinetic_energy_J; };
        bool stopped = false;
        double back = limit;  // the highest place after the impact
        for (const sim::Step& step : r.result.steps) {
            CHECK(energy(step) < energy(r.result.steps[0]) + 0.02 * fallen_J);
            stopped = stopped || step.joints[0].coordinate > limit;
            if (stopped) back = std::min(back, step.joints[0].coordinate);
        }
        MESSAGE(integrator, ": back to ", back * 180 / pi, " degrees");
        CHECK(stopped);
        CHECK(back > 0.5 * limit);
        CHECK(r.joint().coordinate == near(limit, {.absolute = 0.01}));
        CHECK(r.last().kinetic_energy_J < 0.01 * fallen_J);
    }
}

TEST_CASE("a slider sinks on its spring, transmits torque, and is moved by a force") {
    const double stiffness = 100;
    const JointedRun r = run_jointed(jointed_world(
        bar("bar", false) + joint("slider", "world", "bar", 0, 0, "axis = [0, 0, 1]\nstiffness = \"0.1 N/mm\""),
        at_rest()));
    CHECK(r.joint().coordinate == near(-bar_kg * g / stiffness, {.relative = 2e-3}));
    CHECK(r.joint().effort == near(bar_kg * g, {.relative = 2e-3}));
    CHECK(r.joint().force_N.z == near(bar_kg * g, {.relative = 2e-3}));
    CHECK(r.joint().torque_Nm.y == near(-bar_kg * g * bar_m / 2, {.relative = 2e-3}));
    const double T = 0.1, force = 0.02;  // grows evenly
    const JointedRun pushed = run_jointed(
        jointed_world(bar("bar", false) + joint("slider", "world", "bar", 0, 0, "axis = [1, 0, 0]\nforce = \"20 mN\""),
                      in_time(T, 0.001)));
    CHECK(pushed.joint().coordinate == near(force / bar_kg * T * T / 6, {.relative = 0.01}));
    CHECK(pushed.joint().effort == near(force, {.relative = 1e-6}));
}

TEST_CASE("two boxes glued together move as one") {
    const auto box = [](const std::string& name, double low, double high, double vy) {
        return fmt::format(
            "[[object]]\nname = \"{}\"\ngeometry = {{ box = [[{}, -5, -3], [{}, 5, 3]] }}\ndensity = \"1000 "
            "kg/m^3\"\nvelocity = [0.2, {}, 0.5]\nangular_velocity = [5, 0, 20]\n",
            name, low, high, vy);
    };
    const std::string program = in_time(0.1, 0.0005);
    const JointedRun whole = run_jointed(jointed_world(box("one", -20, 20, 0), program));
    const JointedRun glued = run_jointed(jointed_world(
        box("left", -20, 0, -20 * 0.01) + box("right", 0, 20, 20 * 0.01) + joint("glue", "left", "right", 0, 0),
        program));
    const auto& one = whole.last().objects[0];
    const auto &left = glued.last().objects[0], &right = glued.last().objects[1];
    const Vec3 middle = 0.5 * (left.position_m + right.position_m);
    CHECK(norm(middle - one.position_m) < 1e-4 * 0.1);
    CHECK(norm(left.position_m - right.position_m) == near(0.02, {.relative = 1e-4}));
    for (std::size_t k = 0; k < 4; ++k) CHECK(left.rotation[k] == near(one.rotation[k], {.absolute = 5e-3}));
}

TEST_CASE("a motor follows its angle over several turns") {
    const JointedRun r = run_jointed(
        jointed_world(bar("bar", false) + joint("motor", "world", "bar", 0, 0, "axis = [0, 0, 1]\nangle = \"720 deg\""),
                      in_time(1, 0.01, false)));
    for (std::size_t k = 1; k < r.result.steps.size(); k += 9) {
        const sim::Step& step = r.result.steps[k];
        CHECK(step.joints[0].coordinate == near(4 * pi * step.time, {.absolute = 0.01}));
        CHECK(step.objects[0].position_m.x == near(0.05 * std::cos(4 * pi * step.time), {.absolute = 1e-3}));
    }
}

TEST_CASE("damping by stiffness does not brake what turns as a whole") {
    const double spin = 20;
    const auto end = [&](int side) {
        return fmt::format(
            "[[plate]]\nname = \"p{0}\"\nplane = {{ point = [{1}, 0, 0], normal = [1, 0, 0] }}\n[[object]]\n"
            "name = \"o{0}\"\ngeometry = {{ box = [[{2}, -5, -5], [{3}, 5, 5]] }}\nmass = \"20 g\"\n"
            "velocity = [0, {4}, 0]\nangular_velocity = [0, 0, {5}]\n[[joint]]\nname = \"j{0}\"\n"
            "kind = \"glue\"\nbetween = [\"p{0}\", \"o{0}\"]\npoint = [{1}, 0, 0]\n",
            side + 1, 20 * side, side > 0 ? 21 : -31, side > 0 ? 31 : -21, 0.026 * spin * side, spin);
    };
    const std::string dumbbell =
        "name = \"dumbbell\"\nlength_unit = \"mm\"\n[material.m]\nyoungs_modulus = \"1 MPa\"\npoisson_ratio = 0.45\n"
        "density = \"1 kg/m^3\"\n[[body]]\nname = \"bar\"\nmaterial = \"m\"\n"
        "geometry = { box = [[-20, -5, -5], [20, 5, 5]] }\n[mesh]\nsize = \"10 mm\"\norder = 1\n" +
        end(-1) + end(1);
    for (const char* integrator : {"bdf2", "energy-conserving"}) {
        CAPTURE(integrator);
        const JointedRun r = run_jointed(fmt::format(
            "{}[program]\nduration = \"0.2 s\"\ntime_step = \"5 ms\"\nstiffness_damping = 0.002\nintegrator = \"{}\"\n",
            dumbbell, integrator));
        const auto angle = [&](std::size_t k) {
            const std::vector<sim::ObjectState>& objects = r.result.steps[k].objects;
            const Vec3 along = objects[1].position_m - objects[0].position_m;
            return std::atan2(along.y, along.x);
        };
        const auto spin_at = [&](std::size_t k) { return std::remainder(angle(k) - angle(k - 1), 2 * pi) / 0.005; };
        // The first step is implicit Euler's, which loses a tenth.
        CHECK(spin_at(4) == near(spin, {.relative = 0.12}));
        CHECK(spin_at(40) == near(spin_at(4), {.relative = 0.005}));
        if (std::string(integrator) == "energy-conserving") CHECK(spin_at(40) == near(spin, {.relative = 0.01}));
    }
}

TEST_CASE("a motor turns a bar that nothing resists, and past half a turn it is as stable as before") {
    for (const char* gravity : {"", "gravity = [0, 0, -9.81]\n"}) {
        CAPTURE(gravity);
        for (const int steps : {20, 40}) {
            const JointedRun r = run_jointed(jointed_world(
                bar("bar", false) + joint("motor", "world", "bar", 0, 0, "axis = [0, 1, 0]\nangle = \"360 deg\""),
                fmt::format("steps = {}\n{}", steps, gravity)));
            CAPTURE(steps);
            CHECK(r.joint().coordinate == near(2 * pi, {.absolute = 1e-3}));
            for (const std::string& warning : r.result.warnings)
                CHECK_MESSAGE(warning.find("unstable") == std::string::npos, warning);
            int iterations = 0;
            for (const sim::Step& step : r.result.steps) iterations += step.iterations;
            CHECK(iterations < 30 * steps);
        }
    }
}

TEST_CASE("links that hang from a soft arm by ball joints come to hang along gravity in a few iterations") {
    const std::string arm =
        "[material.heavy]\nyoungs_modulus = \"0.5 MPa\"\npoisson_ratio = 0.45\ndensity = \"1100 kg/m^3\"\n"
        "[[body]]\nname = \"arm\"\nmaterial = \"heavy\"\ngeometry = { box = [[0, -6, 0], [60, 6, 12]] }\n"
        "[[fixed]]\nname = \"wall\"\nplane = { point = [0, 0, 0], normal = [1, 0, 0] }\n"
        "rotate = { angle = 20, axis = [0, 1, 0], center = [0, 0, 0] }\n";
    const auto link = [](const std::string& name, double top_mm) {
        return fmt::format(
            "[[object]]\nname = \"{}\"\ngeometry = {{ sphere = {{ center = [55, 0, {}], radius = 6 }} }}\n"
            "density = \"1000 kg/m^3\"\n",
            name, top_mm - 6);
    };
    const auto held = [](const std::string& above, const std::string& name, double z_mm) {
        return fmt::format(
            "[[joint]]\nname = \"ring of {1}\"\nkind = \"ball\"\nbetween = [\"{0}\", \"{1}\"]\n"
            "point = [55, 0, {2}]\n",
            above, name, z_mm);
    };
    const std::string chain =
        link("upper", -2) + link("lower", -16) + held("arm", "upper", -1) + held("upper", "lower", -15);
    const JointedRun r = run_jointed(jointed_world(arm + chain, "steps = 2\ngravity = [1, 2, -9.81]\n"));
    const Vec3 down = Vec3{1, 2, -9.81} / norm(Vec3{1, 2, -9.81});
    const Vec3 between = r.last().objects.at(1).position_m - r.last().objects.at(0).position_m;
    CHECK(dot(between, down) == near(0.014, {.relative = 1e-3}));  // 7 mm to either side of their joint
    int iterations = 0;
    for (const sim::Step& step : r.result.steps) {
        CHECK(step.substeps == 1);
        iterations += step.iterations;
    }
    CHECK(iterations < 60);  // 15 to 30, and some thousands where turns cancel swings
}

TEST_CASE("a ball joint transmits a force and no torque") {
    const JointedRun r = run_jointed(jointed_world(bar("bar", true) + joint("ball", "world", "bar", 0, 0), at_rest()));
    CHECK(r.joint().force_N.z == near(bar_kg * g, {.relative = 1e-3}));
    CHECK(norm(r.joint().torque_Nm) < 1e-9);
}

TEST_CASE("a cable turns a hinged link until the torques balance") {
    const double stiffness = 0.05;
    const JointedRun r = run_jointed(jointed_world(
        bar("bar", false) +
            joint("hinge", "world", "bar", 0, 0, about_y + fmt::format("\nstiffness = \"{} N*m/rad\"", stiffness)) +
            "[[cable]]\nname = \"pull\"\npoints = [[0, 0, 80], [80, 0, 0]]\nanchor = \"first\"\n"
            "target = { tension = \"0.5 N\" }\n",
        "steps = 3\n"));
    // The link's end at angle a about y is at (80 cos a, 0, -80 sin a) mm.
    const double a = r.joint().coordinate, x = 0.08 * std::cos(a), z = -0.08 * std::sin(a);
    const double length = std::hypot(x, 0.08 - z);
    const double torque = 0.5 * (z * (0 - x) - x * (0.08 - z)) / length;  // (r x F) . y
    CHECK(a < -0.1);
    CHECK(stiffness * a == near(torque, {.relative = 5e-3}));
    CHECK(r.last().cables[0].length_m == near(length, {.relative = 1e-3}));
}

namespace {

/// A light beam of 60 mm, clamped, with a block of 10 mm glued to its end face, which a plate keeps rigid.
std::string beam_with_block(double block_kg, const std::string& program) {
    return fmt::format(R"(
name = "beam"
length_unit = "mm"
material.rubber = {{ youngs_modulus = "1 MPa", poisson_ratio = 0.3, density = "1 kg/m^3" }}
body = [{{ name = "beam", material = "rubber", geometry = {{ box = [[0, 0, 0], [60, 10, 10]] }} }}]
mesh = {{ size = "10 mm" }}
fixed = [{{ name = "clamp", plane = {{ point = [0, 0, 0], normal = [1, 0, 0] }} }}]
plate = [{{ name = "end", plane = {{ point = [60, 0, 0], normal = [1, 0, 0] }} }}]
marker = [{{ name = "tip", point = [60, 5, 5] }}]
object = [{{ name = "block", geometry = {{ box = [[60, 0, 0], [70, 10, 10]] }}, mass = "{} kg" }}]
joint = [{{ name = "weld", kind = "glue", between = ["end", "block"], point = [60, 5, 5] }}]
[program]
tolerance = 1e-6
gravity = [0, 0, -9.81]
)",
                       block_kg) +
           program;
}

/// Flexibility of the end of a beam: deflection by force and by moment, slope by moment; with shear (Timoshenko).
struct Flexibility {
    double EI = 1e6 * 1e-8 / 12, L = 0.06, G = 1e6 / 2.6, A = 1e-4, kappa = 5.0 / 6;
    double by_force = L * L * L / (3 * EI) + L / (kappa * G * A), across = L * L / (2 * EI), by_moment = L / EI;
};

}  // namespace

TEST_CASE("a soft beam with a rigid block glued to its end sinks and swings as Timoshenko beam theory says") {
    const Flexibility f;
    const double m = 1e-3, c = 5e-3;
    {
        const JointedRun r = run_jointed(beam_with_block(m, "steps = 2\n"));
        const double sunk = 5e-3 - r.last().markers[0].position_m.z;
        const double wanted = m * g * (f.by_force + c * f.across);
        MESSAGE("sunk by ", sunk, " m, wanted ", wanted);
        CHECK(sunk == near(wanted, {.relative = 0.03}));
        CHECK(r.joint().force_N.z == near(m * g, {.relative = 2e-3}));
        CHECK(r.joint().torque_Nm.y == near(-m * g * c, {.relative = 0.02}));
    }
    // Deflection and slope of the end carry the block: the larger eigenvalue of flexibility times mass is 1 / w^2.
    const double M = 5e-3, J = M * 2e-4 / 12;
    const double a = f.by_force * M + f.across * M * c, b = f.by_force * M * c + f.across * (J + M * c * c);
    const double d = f.across * M + f.by_moment * M * c, e = f.across * M * c + f.by_moment * (J + M * c * c);
    const double largest = 0.5 * (a + e) + std::sqrt(0.25 * (a - e) * (a - e) + b * d);
    const double period = 2 * pi * std::sqrt(largest);
    const JointedRun r = run_jointed(
        beam_with_block(M, fmt::format("duration = \"{} s\"\ntime_step = \"{} s\"\n", 2.2 * period, period / 120)));
    std::vector<double> turns;  // where it comes to rest
    const auto height = [&](std::size_t k) { return r.result.steps[k].markers[0].position_m.z; };
    for (std::size_t k = 1; k + 1 < r.result.steps.size(); ++k) {
        const double before = height(k) - height(k - 1), after = height(k + 1) - height(k);
        if ((before > 0) != (after > 0))
            turns.push_back(r.result.steps[k].time + period / 120 * (before / (before - after) - 0.5));
    }
    REQUIRE(turns.size() >= 3);
    MESSAGE("period ", turns[2] - turns[0], " s, wanted ", period);
    CHECK(turns[2] - turns[0] == near(period, {.relative = 0.03}));
}

TEST_CASE("a joint on a soft beam, or on its rigid end, gives the same answer however the robot is turned") {
    const test::Folder folder("turned");
    mesh::TetMesh beam = mesh::scaled(run_jointed(beam_with_block(1e-3, "steps = 1\n")).built.model.mesh(), 1e3);
    beam.region_names = {"beam"};
    REQUIRE(mesh::write_tet_mesh(folder.path() / "beam.vtk", beam));
    // Turned by a third of a turn about (1, 1, 1), which takes x to y, y to z, and z to x.
    const auto point = [](bool turned, double x, double y, double z) {
        return turned ? fmt::format("[{}, {}, {}]", z, x, y) : fmt::format("[{}, {}, {}]", x, y, z);
    };
    const auto solved = [&](bool turned, const std::string& kind, const std::string& first) {
        const auto at = [&](double x, double y, double z) { return point(turned, x, y, z); };
        std::string free = "kind = \"glue\"";
        if (kind == "hinge") free = "kind = \"hinge\", stiffness = \"2 N mm/rad\", axis = " + at(0, 1, 0);
        if (kind == "slider") free = "kind = \"slider\", stiffness = \"5 N/m\", axis = " + at(0, 0, 1);
        const std::string text =
            "name = \"beam\"\nlength_unit = \"mm\"\n"
            "material.rubber = { youngs_modulus = \"1 MPa\", poisson_ratio = 0.3, density = \"1 kg/m^3\" }\n"
            "body = [{ name = \"beam\", material = \"rubber\", region = \"all\" }]\n"
            "mesh = { file = \"beam.vtk\", place = { rotate = { axis = [1, 1, 1], angle = " +
            std::string(turned ? "120" : "0") +
            " } } }\nfixed = [{ name = \"clamp\", plane = { point = " + at(0, 0, 0) + ", normal = " + at(1, 0, 0) +
            " } }]\nplate = [{ name = \"end\", plane = { point = " + at(60, 0, 0) + ", normal = " + at(1, 0, 0) +
            " } }]\nmarker = [{ name = \"tip\", point = " + at(60, 5, 5) +
            " }]\nobject = [{ name = \"block\", mass = \"1 g\", geometry = { box = [" + at(60, 0, 0) + ", " +
            at(70, 10, 10) + "] } }]\njoint = [{ name = \"pin\", " + free + ", between = [\"" + first +
            "\", \"block\"], point = " + at(60, 5, 5) +
            " }]\n[contact]\n[program]\nsteps = 1\ntolerance = 1e-8\ngravity = " + at(0, 0, -9.81) + "\n";
        auto built = robot::testing::build(robot::parse_robot(text, folder.path() / "beam.toml"));
        return robot::testing::run_to_the_end(built).steps.back();
    };
    for (const char* kind : {"hinge", "slider", "glue"}) {
        for (const char* first : {"end", "beam"}) {
            CAPTURE(kind);
            CAPTURE(first);
            const sim::Step plain = solved(false, kind, first), turned = solved(true, kind, first);
            if (kind == std::string_view("hinge")) CHECK(plain.joints[0].coordinate > 0.01);
            if (kind == std::string_view("slider")) CHECK(plain.joints[0].coordinate < -1e-3);
            CHECK(turned.joints[0].coordinate == near(plain.joints[0].coordinate, {.relative = 1e-5}));
            const Vec3 there = turned.markers[0].position_m, back{there.y, there.z, there.x};
            CHECK(norm(back - plain.markers[0].position_m) < 1e-8);
        }
    }
}

TEST_CASE("joints give the same bits on any number of threads, and after reading from bytes") {
    const auto built = robot::testing::build(robot::parse_robot(
        jointed_world(bar("upper", false) + bar("lower", false, 100, "angular_velocity = [0, 30, 0]") +
                          joint("motor", "world", "upper", 0, 0, about_y + "\ntorque = \"0.02 N*m\"\ndamping = 1e-4") +
                          joint("hinge", "upper", "lower", 100, 0, about_y),
                      in_time(0.1, 0.005)),
        "jointed.toml"));
    Progress silent;
    const auto steps = [&](sim::Stepper& stepper, sim::RobotState& robot, int from, int to) {
        for (int k = from; k <= to; ++k)
            REQUIRE(stepper.step(robot, sim::program_path(stepper, built.robot.program, robot, k), silent).arrived);
    };
    sim::Stepper stepper(built.model, sim::stepper_options(built.robot.program));
    sim::RobotState robot = stepper.rest();
    steps(stepper, robot, 1, 10);
    const std::string bytes = sim::state_bytes(built.model, robot);
    steps(stepper, robot, 11, 20);
    for (const std::size_t threads : {1, 2, 4}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        sim::Stepper other(built.model, sim::stepper_options(built.robot.program));
        auto read = sim::state_from_bytes(other, bytes);
        REQUIRE_MESSAGE(read, (read ? "" : read.error().message));
        steps(other, *read, 11, 20);
        CHECK(read->x() == robot.x());
        CHECK(read->controls.joint_start == robot.controls.joint_start);
    }
}

TEST_CASE("mistakes in joints give one line each") {
    using robot::testing::check_problem;
    const auto check = [&](const std::string& keys, const std::string& wanted) {
        check_problem(jointed_world(bar("bar", false) + "[[joint]]\nname = \"it\"\n" + keys, at_rest()), wanted);
    };
    const std::string held = "between = [\"world\", \"bar\"]\npoint = [0, 0, 0]\n";
    check("kind = \"weld\"\n" + held, "glue");
    check("kind = \"hinge\"\n" + held, "\"axis\" is missing");
    check("kind = \"hinge\"\naxis = [0, 0, 0]\n" + held, "must not be zero");
    check("kind = \"glue\"\naxis = [0, 0, 1]\n" + held, "is that of a hinge, motor or slider");
    check("kind = \"ball\"\nbetween = [\"world\", \"beam\"]\npoint = [0, 0, 0]\n",
          "there is no body, plate or object \"beam\"");
    check("kind = \"ball\"\nbetween = [\"bar\", \"bar\"]\npoint = [0, 0, 0]\n", "joins \"bar\" to itself");
    check("kind = \"ball\"\nbetween = [\"bar\"]\npoint = [0, 0, 0]\n", "names two things");
    check("kind = \"ball\"\nbetween = [\"post\", \"bar\"]\npoint = [0, 0, 0]\n", "lies outside body \"post\", by");
    check("kind = \"motor\"\naxis = [0, 0, 1]\n" + held, "a motor takes angle or torque");
    check("kind = \"motor\"\naxis = [0, 0, 1]\nangle = \"3 deg\"\ntorque = \"1 N*m\"\n" + held,
          "takes one of angle and torque");
    check("kind = \"motor\"\naxis = [0, 0, 1]\ntorque = \"1 N\"\n" + held,
          "unknown unit \"N\"; here the units are N mm");
    check("kind = \"hinge\"\naxis = [0, 0, 1]\nangle = \"3 deg\"\n" + held, "kind = \"motor\"");
    check("kind = \"motor\"\naxis = [0, 0, 1]\nangle = \"30 deg\"\nlimits = [-10, 10]\n" + held,
          "its target of 30 lies outside its limits, [-10, 10] degrees");
    check("kind = \"hinge\"\naxis = [0, 0, 1]\nlimits = [10, 20]\n" + held, "must lie between them");
    check("kind = \"slider\"\naxis = [0, 0, 1]\nangle = \"3 deg\"\n" + held, "a slider takes position or force");
    check("kind = \"ball\"\nstiffness = \"1 N/m\"\n" + held, "a [[spring]] is elastic");
}
