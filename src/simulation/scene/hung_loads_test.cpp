// Loads at points, along lines, on nodes, plates and objects, and masses with inertia, from the robot file: against
// closed forms. The beam is 100 x 10 x 10 mm, of Poisson ratio 0, so that its clamp does not stiffen it.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/core/near.hpp"
#include "simulation/scene/test_beam.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;
using robot::testing::beam_edge;
using robot::testing::beam_length;
using robot::testing::beam_modulus;
using robot::testing::run_text;

namespace {

constexpr double bending_stiffness = beam_modulus * beam_edge * beam_edge * beam_edge * beam_edge / 12;

std::string beam(const std::string& more, const std::string& program = "steps = 1\n") {
    return R"(
name = "beam"
length_unit = "mm"
material.rubber = { youngs_modulus = "1 MPa", poisson_ratio = 0, density = "1 kg/m^3" }
body = [{ name = "beam", material = "rubber", geometry = { box = [[0, 0, 0], [100, 10, 10]] } }]
mesh = { size = "10 mm" }
fixed = [{ name = "clamp", plane = { point = [0, 0, 0], normal = [1, 0, 0] } }]
[[marker]]
name = "tip"
point = [100, 5, 5]
[[marker]]
name = "near"
point = [20, 5, 10]
[[marker]]
name = "far"
point = [80, 5, 10]
)" + more + "\n[program]\n" +
           program;
}

Vec3 marker(const sim::Trajectory& result, std::size_t k) {
    return result.steps.back().markers.at(k).position_m;
}

double sag(const std::string& load) {
    return beam_edge / 2 - marker(run_text(beam(load)), 0).z;
}

const std::string end_plate = "[[plate]]\nname = \"end\"\nplane = { point = [100, 0, 0], normal = [1, 0, 0] }\n";

}  // namespace

TEST_CASE("a beam sags under a force at a point, along a line and on nodes as Euler and Bernoulli say") {
    const double F = 2e-3;
    const std::string force = "force = [\"0 N\", \"0 N\", \"-2 mN\"]\n", head = "[[load]]\nname = \"hung\"\n";
    const double tip = F * std::pow(beam_length, 3) / (3 * bending_stiffness), a = beam_length / 2;
    CHECK(sag(head + "point = [100, 5, 5]\n" + force) == near(tip, {.relative = 0.02}));
    CHECK(sag(head + "point = [50, 5, 10]\nradius = \"6 mm\"\n" + force) ==
          near(F * a * a * (3 * beam_length - a) / (6 * bending_stiffness), {.relative = 0.02}));
    CHECK(sag(head + "line = [[0, 5, 10], [100, 5, 10]]\n" + force) ==
          near(F * std::pow(beam_length, 3) / (8 * bending_stiffness), {.relative = 0.02}));
    CHECK(sag(head + "plane = { point = [100, 0, 0], normal = [1, 0, 0] }\non = \"nodes\"\n" + force) ==
          near(tip, {.relative = 0.02}));
    // Half of it at each of two points is the mean of both.
    const double both = sag(head + "points = [[100, 5, 5], [50, 5, 10]]\n" + force);
    CHECK(both == near(0.5 * (tip + F * a * a * (3 * beam_length - a) / (6 * bending_stiffness)), {.relative = 0.02}));
}

TEST_CASE("a load along an edge gives its force and moment") {
    const auto built =
        robot::testing::build(robot::parse_robot(beam("[[load]]\nname = \"edge\"\nline = [[20, 10, 10], [90, 10, "
                                                      "10]]\nforce = [\"1 mN\", \"2 mN\", \"-3 mN\"]\n"),
                                                 "beam.toml"));
    const sim::Load& load = built.model.description().loads.at(0);
    Vec3 force, moment;
    for (std::size_t k = 0; k < load.nodes.size(); ++k) {
        const Vec3 f = load.shares[k] * load.force_N;
        force += f;
        moment += cross(built.model.mesh().points[static_cast<std::size_t>(load.nodes[k])], f);
    }
    const Vec3 wanted = cross(Vec3{0.055, 0.01, 0.01}, load.force_N);
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(force[i] == near(load.force_N[i], {.relative = 1e-12}));
        CHECK(moment[i] == near(wanted[i], {.relative = 1e-9}));
    }
}

TEST_CASE("a torque on a plate bends a beam to an arc, up to a quarter of a circle") {
    const double angle = std::numbers::pi / 2, torque = bending_stiffness * angle / beam_length;
    const sim::Trajectory result = run_text(
        beam(end_plate + fmt::format("[[load]]\nname = \"bend\"\nplate = \"end\"\ntorque = [\"0 N mm\", \"{} N mm\", "
                                     "\"0 N mm\"]\n",
                                     -1e3 * torque),
             "steps = 6\n"));
    const Vec3 tip = marker(result, 0);
    const double radius = beam_length / angle;
    CHECK(tip.x == near(radius, {.relative = 0.02}));
    CHECK(tip.z - beam_edge / 2 == near(radius, {.relative = 0.02}));
    // The clamp holds no force, only the torque.
    CHECK(norm(result.steps.back().supports[0].force_N) < 1e-3 * torque / beam_length);
}

TEST_CASE("a torque on a plate twists a bar as Saint-Venant says") {
    const double torque = 3e-3, GJ = beam_modulus / 2 * 0.140577 * std::pow(beam_edge, 4);
    const sim::Trajectory result = run_text(
        beam(end_plate + "[[load]]\nname = \"twist\"\nplate = \"end\"\ntorque = [\"3 N mm\", \"0 N mm\", \"0 N mm\"]\n",
             "steps = 2\n"),
        {"mesh.size=4 mm"});
    const auto turned = [&](std::size_t k) {
        const Vec3 p = marker(result, k);
        return std::atan2(-(p.y - beam_edge / 2), p.z - beam_edge / 2);
    };
    CHECK(turned(2) - turned(1) == near(torque * 0.06 / GJ, {.relative = 0.02}));
}

TEST_CASE("a torque and a force accelerate an object as its inertia and mass say") {
    const sim::Trajectory result = run_text(beam(R"(
[contact]
distance = "0.2 mm"
[[object]]
name = "block"
geometry = { box = [[0, 50, 0], [20, 70, 10]] }
mass = "6 g"
[[load]]
name = "spin"
object = "block"
torque = ["0 N mm", "0 N mm", "0.2 N mm"]
force = ["30 mN", "0 N", "0 N"]
)",
                                                 "duration = \"0.1 s\"\ntime_step = \"1 ms\"\n"));
    const sim::ObjectState& end = result.steps.back().objects.at(0);
    const double T = 0.1, I = 6e-3 * (4e-4 + 4e-4) / 12;
    // The load grows in proportion to time: twice integrated, T^2/6 of it.
    CHECK(2 * std::atan2(end.rotation[3], end.rotation[0]) == near(0.2e-3 / I * T * T / 6, {.relative = 2e-3}));
    CHECK(end.position_m.x - 0.01 == near(0.03 / 6e-3 * T * T / 6, {.relative = 2e-3}));
}

TEST_CASE("a mass with inertia on a bar swings as a torsion pendulum") {
    const std::string twist = end_plate +
                              "[[load]]\nname = \"twist\"\nplate = \"end\"\ntorque = [\"0.5 N mm\", \"0 N mm\", "
                              "\"0 N mm\"]\n";
    const auto angle = [](const sim::Step& step) {
        const Vec3 p = step.markers.at(2).position_m;
        return std::atan2(-(p.y - beam_edge / 2), p.z - beam_edge / 2);
    };
    const double still = angle(run_text(beam(twist)).steps.back());
    // From rest under the whole torque it swings to twice that and back, in one period. Of the inertia each node at the
    // end has its part, so that the angle at the plate, 100/80 of that of the marker, gives the stiffness.
    const auto end = [](const sim::Trajectory& result) { return result.steps.back().markers.at(3).position_m; };
    const std::string rim = "[[marker]]\nname = \"rim\"\npoint = [100, 5, 10]\n";
    const Vec3 at = end(run_text(beam(rim + twist)));
    const double stiffness = 0.5e-3 / std::atan2(-(at.y - beam_edge / 2), at.z - beam_edge / 2);
    const double I = 20e-3 * 2 * 24e-3 * 24e-3 / 12;
    const double period = 2 * std::numbers::pi * std::sqrt(I / stiffness);
    const std::string mass =
        "[[mass]]\nname = \"head\"\npoint = [100, 5, 5]\nmass = \"20 g\"\nsize = [\"24 mm\", \"24 mm\", "
        "\"24 mm\"]\nradius = \"8 mm\"\n";
    const sim::Trajectory swing = run_text(
        beam(twist + mass,
             fmt::format("duration = \"{} s\"\ntime_step = \"{} s\"\nkey = [{{ time = \"0 s\", twist = 1 }}]\n",
                         1.2 * period, period / 100)));
    std::size_t lowest = 50;
    for (std::size_t k = 50; k < swing.steps.size(); ++k)
        if (angle(swing.steps[k]) < angle(swing.steps[lowest])) lowest = k;
    CHECK(angle(swing.steps[50]) == near(2 * still, {.relative = 0.02}));
    CHECK(static_cast<double>(lowest) == near(100, {.absolute = 2}));
}

TEST_CASE("a mass glued on beside the beam's end bends it by its weight and moment") {
    const std::string glued = R"(
[[mass]]
name = "arm"
point = [100, 5, 5]
center = [130, 5, 5]
mass = "0.1 g"
inertia = ["1 g mm^2", "2 g mm^2", "2 g mm^2"]
axes = [[1, 0, 0], [0, 1, 0]]
radius = "8 mm"
)";
    const double F = 0.1e-3 * 9.81, M = F * 0.03;
    const double found = beam_edge / 2 - marker(run_text(beam(glued, "steps = 1\ngravity = [0, 0, -9.81]\n")), 0).z;
    const double own = beam_edge / 2 - marker(run_text(beam("", "steps = 1\ngravity = [0, 0, -9.81]\n")), 0).z;
    CHECK(found - own == near(F * std::pow(beam_length, 3) / (3 * bending_stiffness) +
                                  M * beam_length * beam_length / (2 * bending_stiffness),
                              {.relative = 0.02}));
}

TEST_CASE("mistakes in loads and masses give one line each") {
    using robot::testing::check_problem;
    const auto load = [](const std::string& keys) { return beam("[[load]]\nname = \"it\"\n" + keys); };
    const std::string force = "force = [\"0 N\", \"0 N\", \"1 N\"]\n";
    check_problem(load(force),
                  "names no place; add box, plane, sphere, surface, nodes, point, points, line, plate or object");
    check_problem(load("point = [100, 5, 5]\nplate = \"end\"\n" + force), "takes only one of");
    check_problem(load("point = [150, 5, 5]\n" + force),
                  "load \"it\": the point (150, 5, 5) lies outside every body, by 50 mm");
    check_problem(load("line = [[0, 5, 5]]\n" + force), "line: needs at least two points");
    check_problem(load("plate = \"ent\"\n" + force), "load \"it\": there is no plate \"ent\"");
    check_problem(load("object = \"ball\"\n" + force), "load \"it\": there is no object \"ball\"");
    check_problem(load("point = [100, 5, 5]\ntorque = [\"1 N mm\", \"0 N mm\", \"0 N mm\"]\n"),
                  "torque: acts on what is rigid: give plate = \"NAME\" or object = \"NAME\"");
    check_problem(load("point = [100, 5, 5]\npressure = \"1 kPa\"\n"), "pressure: acts on faces");
    check_problem(load("line = [[0, 5, 5], [9, 5, 5]]\nradius = \"1 mm\"\n" + force),
                  "radius: spreads the force at a point");
    check_problem(load("point = [100, 5, 5]\non = \"nodes\"\n" + force), "on: goes with box, plane");
    check_problem(load("plate = \"end\"\ntorque = [\"1 N\", \"0 N mm\", \"0 N mm\"]\n"), "unknown unit \"N\"");
    const auto mass = [](const std::string& keys) {
        return beam("[[mass]]\nname = \"it\"\npoint = [100, 5, 5]\nmass = \"1 g\"\n" + keys);
    };
    check_problem(mass("inertia = [\"1 g mm^2\", \"1 g mm^2\", \"3 g mm^2\"]\n"), "inertia: is not possible");
    check_problem(mass("size = [\"1 mm\", \"1 mm\", \"1 mm\"]\ninertia = [\"1 g mm^2\", \"1 g mm^2\", \"1 g mm^2\"]\n"),
                  "inertia: give either size or inertia");
    check_problem(mass("axes = [[1, 0, 0], [0, 1, 0]]\n"), "axes: have no meaning without size or inertia");
    check_problem(mass("size = [\"1 mm\", \"1 mm\", \"1 mm\"]\naxes = [[1, 0, 0], [1, 1, 0]]\n"),
                  "axes: must be two directions at right angles");
}
