// Robots of the SoftRobots examples in the scenes in which they are published (softrobots/README.md of the reference
// data): on the ground, and with objects that nothing holds.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "base/core/near.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/tet_writer.hpp"
#include "geometry/mesh/placement.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;
namespace fs = std::filesystem;

namespace {

constexpr double g = 9.81;

std::string data(const std::string& file) {
    return std::string(std::getenv("PLIANT_REFERENCE_DATA")) + "/softrobots/" + file;
}

mesh::TetMesh read(const std::string& file) {
    auto mesh = mesh::read_tet_mesh(data(file));
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    return std::move(*mesh);
}

/// Turned about x, then about z, then moved; degrees and the file's own unit.
mesh::TetMesh put(mesh::TetMesh mesh, double about_x, double about_z, const Vec3& move) {
    constexpr double degree = std::numbers::pi / 180;
    mesh::Placement first, then;
    first.motion = {about_x * degree, {1, 0, 0}, {}, {}};
    then.motion = {about_z * degree, {0, 0, 1}, {}, move};
    return mesh::placed(mesh::placed(std::move(mesh), first), then);
}

/// `more` as one more region, "finger K".
void append(mesh::TetMesh& all, const mesh::TetMesh& more, int k) {
    const int first = static_cast<int>(all.points.size());
    all.points.insert(all.points.end(), more.points.begin(), more.points.end());
    for (const int node : more.nodes) all.nodes.push_back(node + first);
    all.region.insert(all.region.end(), more.tet_count(), static_cast<int>(all.region_names.size()));
    all.region_names.push_back(fmt::format("finger{}", k));
}

/// A mesh file of its own for the time of a test.
struct MeshFile {
    fs::path path;
    explicit MeshFile(const mesh::TetMesh& mesh, const std::string& name)
        : path(fs::temp_directory_path() / fmt::format("pliant_{}_{}.vtk", name, getpid())) {
        REQUIRE(mesh::write_tet_mesh(path, mesh));
    }
    MeshFile(const MeshFile&) = delete;
    MeshFile& operator=(const MeshFile&) = delete;
    ~MeshFile() { fs::remove(path); }
};

/// The cable of one finger, with its points where the finger is put; it is pulled at a point that is fixed in space.
std::string cable(int k, const Vec3& pulled_at, double about_x, double about_z, const Vec3& move) {
    mesh::TetMesh path;
    path.points = {{-17.5, 12.5, 2.5},  {-32.5, 12.5, 2.5},  {-47.5, 12.5, 2.5},  {-62.5, 12.5, 2.5},
                   {-77.5, 12.5, 2.5},  {-83.5, 12.5, 4.5},  {-85.5, 12.5, 6.5},  {-85.5, 12.5, 8.5},
                   {-83.5, 12.5, 10.5}, {-77.5, 12.5, 12.5}, {-62.5, 12.5, 12.5}, {-47.5, 12.5, 12.5},
                   {-32.5, 12.5, 12.5}, {-17.5, 12.5, 12.5}};
    std::string text = fmt::format(
        "[[cable]]\nname = \"cable {}\"\nanchor = \"first\"\ntarget = {{ shortening = \"36 mm\" }}\n"
        "points = [[{}, {}, {}]",
        k, pulled_at.x, pulled_at.y, pulled_at.z);
    for (const Vec3& p : put(path, about_x, about_z, move).points)
        text += fmt::format(", [{:.9g}, {:.9g}, {:.9g}]", p.x, p.y, p.z);
    return text + "]\n";
}

struct Place {
    double about_x, about_z;
    Vec3 move, pulled_at;
};
/// Of the three fingers of the gripper.
const std::array<Place, 3> fingers = {{{0, 105, {20, 0, 0}, {3, 10.5, 3}},
                                       {180, 65, {-10, 0, -4}, {3, 10.5, -7}},
                                       {180, 65, {-10, 0, 34}, {3, 10.5, 31.5}}}};

/// The gripper over its floor at y = -160 with its cube, whose weight and friction are those of the scene. The fingers
/// stay where they are; the floor brings the cube up between them, they close, and the floor goes down again.
std::string gripper(const fs::path& mesh, double friction) {
    std::string text = fmt::format(R"(
name = "cable gripper"
length_unit = "mm"
material.silicone = {{ youngs_modulus = "18 MPa", poisson_ratio = 0.3, density = "27015 kg/m^3" }}
mesh = {{ file = "{}", order = 1 }}
body = [{{ name = "fingers", region = "all", material = "silicone" }}]
fixed = [{{ name = "base", box = [[-20, -10, -30], [20, 10, 50]] }}]
contact = {{ distance = "1 mm" }}
object = [{{ name = "cube", geometry = {{ box = [[-10, -160, 0], [10, -140, 20]] }}, mass = "30 g", friction = {} }}]
[[obstacle]]
name = "floor"
plane = {{ point = [0, -160, 0], normal = [0, 1, 0] }}
friction = {}
move = [0, 62, 0]
[program]
time_step = "20 ms"
stiffness_damping = 0.02
gravity = [0, -0.981, 0]
key = [{{ time = "0.4 s", floor = 1, "cable 1" = "0 mm", "cable 2" = "0 mm", "cable 3" = "0 mm" }},
       {{ time = "1 s", floor = 1, "cable 1" = "36 mm", "cable 2" = "36 mm", "cable 3" = "36 mm" }},
       {{ time = "1.3 s", floor = 0 }}, {{ time = "1.5 s", floor = 0 }}]
)",
                                   mesh.string(), friction, friction);
    for (std::size_t k = 0; k < fingers.size(); ++k) {
        const Place& f = fingers[k];
        text += cable(static_cast<int>(k) + 1, f.pulled_at, f.about_x, f.about_z, f.move);
    }
    return text;
}

sim::Trajectory run(const std::string& text) {
    return robot::testing::run_to_the_end(robot::testing::build(robot::parse_robot(text, "scene.toml")));
}

}  // namespace

TEST_CASE("the gripper of three cable fingers closes on its cube and takes it up from the floor") {
    mesh::TetMesh all;
    const mesh::TetMesh finger = read("cable_finger/finger.vtk");
    for (std::size_t k = 0; k < fingers.size(); ++k)
        append(all, put(finger, fingers[k].about_x, fingers[k].about_z, fingers[k].move), static_cast<int>(k) + 1);
    const MeshFile file(all, "gripper");
    const sim::Trajectory held = run(gripper(file.path, 0.08));
    const sim::Step& end = held.steps.back();
    MESSAGE("the cube ends at y = ", 1e3 * end.objects[0].position_m.y, " mm; force on it ", end.objects[0].force_N.y, " N");
    CHECK(end.objects[0].position_m.y > -0.12);  // on the floor it would be at -0.15
    CHECK(norm(end.contacts[0].force_N) == 0);
    CHECK(end.objects[0].force_N.y == near(0.03 * 0.981, {.relative = 0.05}));
}

TEST_CASE("the tripod lies on the ground under its own weight, and contact carries it") {
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
