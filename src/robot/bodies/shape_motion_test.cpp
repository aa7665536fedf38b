// Motion of meshes with the numbers of a drawing.
#include "robot/bodies/shape_motion.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "robot/bodies/build.hpp"
#include "robot/file/robot_file.hpp"

using namespace pliant;
using namespace pliant::robot;
using pliant::test::holds;

namespace {

Robot read(const std::string& text, double p) {
    const auto robot = parse_robot(text, "drawn.toml", {fmt::format("parameters.p={:.17g}", p)});
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    return *robot;
}

struct Moved {
    mesh::TetMesh mesh;  ///< m
    Result<std::vector<Vec3>> motion;
};

/// Of a drawing with the parameter p, which is in millimetres where it is a length.
Moved moved(const std::string& bodies, double p, int order = 1) {
    const std::string text =
        "name = \"drawn\"\nlength_unit = \"mm\"\nparameters = { p = 1 }\n"
        "material.soft = { youngs_modulus = \"1 MPa\", poisson_ratio = 0.45 }\n"
        "fixed = [{ name = \"clamp\", box = [[-50, -50, -50], [0, 50, 50]] }]\n"
        "mesh = { order = " +
        std::to_string(order) + ", size = \"3 mm\" }\n" + bodies;
    const Robot now = read(text, p), more = read(text, p + 1e-4), less = read(text, p - 1e-4);
    Progress silent;
    const auto mesh = build_mesh(now, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    return {*mesh, shape_motion(now, {more, less, 2e-4}, *mesh)};
}

std::string body(const std::string& geometry, const std::string& name = "bar") {
    return "[[body]]\nname = \"" + name + "\"\nmaterial = \"soft\"\ngeometry = " + geometry + "\n";
}

/// Largest error of the motion, m for each mm, against a formula of the place in mm.
double error(const Moved& m, const std::function<Vec3(const Vec3& mm)>& formula) {
    REQUIRE_MESSAGE(m.motion, (m.motion ? "" : m.motion.error().message));
    double worst = 0;
    for (std::size_t n = 0; n < m.mesh.points.size(); ++n)
        worst = std::max(worst, norm((*m.motion)[n] - 1e-3 * formula(1e3 * m.mesh.points[n])));
    return worst;
}

}  // namespace

TEST_CASE("the mesh of a growing box moves linearly") {
    for (const int order : {1, 2}) {
        const Moved m = moved(body("{ box = [[0, 0, 0], [20, 6, \"= p\"]] }"), 8, order);
        CHECK(error(m, [](const Vec3& p) { return Vec3{0, 0, p.z / 8}; }) < 1e-11);
    }
}

TEST_CASE("a moved or rotated part moves as a rigid body") {
    const Moved there =
        moved(body("{ translate = [\"= p\", \"= 2 * p\", 0], of = { box = [[0, 0, 0], [9, 6, 6]] } }"), 3);
    CHECK(error(there, [](const Vec3&) { return Vec3{1, 2, 0}; }) < 1e-11);
    const Moved about = moved(
        body("{ rotate = \"= p\", axis = [0, 0, 1], center = [0, 0, 0], of = { box = [[0, 0, 0], [9, 6, 6]] } }"), 20);
    const double rate = M_PI / 180;
    // Nodes may slide within faces: normal to them they rotate with the part.
    REQUIRE_MESSAGE(about.motion, (about.motion ? "" : about.motion.error().message));
    const double c = std::cos(20 * rate), s = std::sin(20 * rate);
    int checked = 0;
    for (std::size_t n = 0; n < about.mesh.points.size(); ++n) {
        const Vec3 p = about.mesh.points[n], v = (*about.motion)[n], turning = rate * Vec3{-p.y, p.x, 0};
        const Vec3 own{1e3 * (c * p.x + s * p.y), 1e3 * (c * p.y - s * p.x), 1e3 * p.z};
        const auto across = [&](const Vec3& normal) {
            CHECK(dot(v, normal) == near(dot(turning, normal), {.absolute = 1e-12}));
            ++checked;
        };
        if (std::fabs(own.x) < 1e-9 || std::fabs(own.x - 9) < 1e-9) across({c, s, 0});
        if (std::fabs(own.y) < 1e-9 || std::fabs(own.y - 6) < 1e-9) across({-s, c, 0});
    }
    CHECK(checked > 20);
}

TEST_CASE("round surfaces stay round, mid-edge nodes included") {
    const Moved m = moved(body("{ cylinder = { from = [0, 0, 0], to = [0, 0, 12], radius = \"= p\" } }"), 5, 2);
    REQUIRE_MESSAGE(m.motion, (m.motion ? "" : m.motion.error().message));
    int on = 0;
    for (std::size_t n = 0; n < m.mesh.points.size(); ++n) {
        const Vec3 p = 1e3 * m.mesh.points[n];
        const double r = std::hypot(p.x, p.y);
        if (std::fabs(r - 5) > 1e-5) continue;
        const Vec3 v = 1e3 * (*m.motion)[n];
        CHECK((v.x * p.x + v.y * p.y) / r == near(1, {.relative = 1e-9}));
        ++on;
    }
    CHECK(on > 50);
}

TEST_CASE("bodies that touch have the same motion at their common face") {
    const Moved m = moved(body("{ box = [[0, 0, 0], [20, 6, \"= p\"]] }", "low") +
                              body("{ box = [[0, 0, \"= p\"], [20, 6, 12]] }", "high"),
                          5);
    CHECK(error(m, [](const Vec3& p) { return Vec3{0, 0, p.z < 5 ? p.z / 5 : (12 - p.z) / 7}; }) < 1e-11);
}

TEST_CASE("bodies that come apart have no motion; a number that moves nothing gives zero motion") {
    const Moved apart = moved(
        body("{ box = [[0, 0, 0], [20, 6, \"= p\"]] }", "low") + body("{ box = [[0, 0, 5], [20, 6, 12]] }", "high"), 5);
    REQUIRE_FALSE(apart.motion);
    CHECK(holds(apart.motion.error().message, "move apart or into each other"));
    const Moved still = moved(body("{ box = [[0, 0, 0], [20, 6, 6]] }"), 5);
    CHECK(error(still, [](const Vec3&) { return Vec3{}; }) == 0);
}

TEST_CASE("the mesh follows a moving hole") {
    const Moved m =
        moved(body("{ difference = [{ box = [[0, 0, 0], [30, 6, 12]] }, { cylinder = { from = [\"= p\", -1, "
                   "6], to = [\"= p\", 7, 6], radius = 3 } }] }"),
              15);
    REQUIRE_MESSAGE(m.motion, (m.motion ? "" : m.motion.error().message));
    for (std::size_t n = 0; n < m.mesh.points.size(); ++n) {
        const Vec3 p = 1e3 * m.mesh.points[n], v = 1e3 * (*m.motion)[n];
        const Vec3 from_axis{p.x - 15, 0, p.z - 6};
        if (std::fabs(norm(from_axis) - 3) < 1e-6)
            CHECK(dot(v, from_axis) / 3 == near(from_axis.x / 3, {.absolute = 1e-9}));
        if (p.x < 1e-9 || p.x > 30 - 1e-9) CHECK(std::fabs(v.x) < 1e-12);
    }
}
