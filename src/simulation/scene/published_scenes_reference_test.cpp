// Robots of the SoftRobots examples in the scenes in which they are published (softrobots/README.md of the reference
// data): on the ground, held by nothing, or with a thing to grasp.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/tet_writer.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;
using robot::testing::g;
using robot::testing::run_text;

namespace {

std::string data(const std::string& file) {
    return std::string(std::getenv("PLIANT_REFERENCE_DATA")) + "/softrobots/" + file;
}

/// Where the scene places a finger of its gripper: turned about x by half a turn or not at all, then about z, then
/// moved.
struct Place {
    const char* name;
    bool turned;
    double degrees;
    Vec3 shift, pull_point;  ///< mm

    [[nodiscard]] Vec3 operator()(const Vec3& p) const {
        const double sign = turned ? -1 : 1, angle = degrees * std::numbers::pi / 180;
        const Vec3 q{p.x, sign * p.y, sign * p.z};
        return Vec3{std::cos(angle) * q.x - std::sin(angle) * q.y, std::sin(angle) * q.x + std::cos(angle) * q.y, q.z} +
               shift;
    }
};

const std::array<Place, 3> fingers{{{"one", false, 105, {20, 0, 0}, {3, 10.5, 3}},
                                    {"two", true, 65, {-10, 0, -4}, {3, 10.5, -7}},
                                    {"three", true, 65, {-10, 0, 34}, {3, 10.5, 31.5}}}};

mesh::TetMesh gripper_mesh() {
    const Result<mesh::TetMesh> read = mesh::read_tet_mesh(data("cable_finger/finger.vtk"));
    REQUIRE(read);
    mesh::TetMesh all = *read;
    all.points.clear();
    all.nodes.clear();
    all.region.clear();
    for (const Place& place : fingers) {
        const int first = static_cast<int>(all.points.size());
        for (const Vec3& p : read->points) all.points.push_back(place(p));
        for (const int node : read->nodes) all.nodes.push_back(first + node);
        all.region.insert(all.region.end(), read->region.begin(), read->region.end());
    }
    return all;
}

std::string finger_cable(const Place& place) {
    const auto text = [](const Vec3& p) { return fmt::format("[{}, {}, {}]", p.x, p.y, p.z); };
    std::string points = text(place.pull_point);
    for (const Vec3& p : {Vec3{-17.5, 12.5, 2.5},
                          {-32.5, 12.5, 2.5},
                          {-47.5, 12.5, 2.5},
                          {-62.5, 12.5, 2.5},
                          {-77.5, 12.5, 2.5},
                          {-83.5, 12.5, 4.5},
                          {-85.5, 12.5, 6.5},
                          {-85.5, 12.5, 8.5},
                          {-83.5, 12.5, 10.5},
                          {-77.5, 12.5, 12.5},
                          {-62.5, 12.5, 12.5},
                          {-47.5, 12.5, 12.5},
                          {-32.5, 12.5, 12.5},
                          {-17.5, 12.5, 12.5}})
        points += ", " + text(place(p));
    return fmt::format("[[cable]]\nname = \"{}\"\nanchor = \"first\"\npoints = [{}]\n", place.name, points) +
           "target = { shortening = \"20 mm\" }\n";
}

}  // namespace

TEST_CASE("the tripod rests on the ground, and the contact force equals its weight") {
    const sim::Trajectory lies = run_text(fmt::format(R"(
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

TEST_CASE("the gripper of three cable fingers takes a cube from the floor and holds it") {
    // The cube of the scene, of 20 mm, fits between the two fingers on one side: here it has 40 mm. The floor goes down
    // instead of the gripper up, so that the cables are pulled out where the scene pulls them. When it has stopped, the
    // fingers swing with the cube for half a second more, by some per cent of its weight.
    const test::Folder folder;
    REQUIRE(write_file(folder / "gripper.vtk", mesh::vtk_bytes(gripper_mesh(), mesh::Encoding::binary)));
    std::string text = fmt::format(R"(
name = "gripper"
length_unit = "mm"
material.silicone = {{ law = "corotated", youngs_modulus = "9 MPa", poisson_ratio = 0.3, density = "27014 kg/m^3" }}
mesh = {{ file = "{}", order = 1 }}
body = [{{ name = "fingers", region = "all", material = "silicone" }}]
fixed = [{{ name = "arm", box = [[-20, -10, -30], [20, 10, 50]] }}]
contact = {{ distance = "0.5 mm", friction = 0.08 }}
[[obstacle]]
name = "floor"
plane = {{ point = [0, -115, 0], normal = [0, 1, 0] }}
friction = 0.08
move = [0, -30, 0]
[[object]]
name = "cube"
geometry = {{ box = [[-20, -114.5, -10], [20, -74.5, 30]] }}
mass = "0.03 kg"
friction = 0.08
[program]
duration = "2.1 s"
time_step = "30 ms"
stiffness_damping = 0.01
gravity = [0, -0.981, 0]
key = [{{ time = "0.6 s", one = "20 mm", two = "20 mm", three = "20 mm", floor = 0 }}, {{ time = "1.2 s", floor = 1 }}]
)",
                                   (folder / "gripper.vtk").string());
    for (const Place& place : fingers) text += finger_cable(place);
    const sim::Trajectory held = run_text(text);
    const sim::Step &last = held.steps.back(), &before = held.steps[held.steps.size() - 6];
    CHECK(last.objects[0].position_m.y > -0.090);  // the floor is at -0.145
    CHECK(last.objects[0].position_m.y == near(before.objects[0].position_m.y, {.absolute = 1e-4}));
    CHECK(last.objects[0].force_N.y == near(0.03 * 0.981, {.relative = 0.01}));
    CHECK(last.contacts[0].force_N == Vec3{0, 0, 0});
    for (const sim::CableState& flexor : last.cables) CHECK(flexor.tension_N > 10);
}
