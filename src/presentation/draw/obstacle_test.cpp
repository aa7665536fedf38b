#include "presentation/draw/obstacle.hpp"

#include <doctest/doctest.h>

#include <numbers>

#include "base/core/near.hpp"
#include "presentation/report/simulation.hpp"
#include "presentation/report/test_robot.hpp"

using namespace pliant;
using namespace pliant::report;

TEST_CASE("a disc lies on its plane, faces along its normal, and has a disc's area") {
    const Vec3 center{0.1, -0.2, 0.3}, normal = Vec3{1, 2, -2} / 3.0;
    const mesh::TriMesh mesh = disc(center, normal, 0.05);
    double area = 0;
    for (const auto& t : mesh.triangles) {
        const auto point = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(t[k])]; };
        const Vec3 twice = cross(point(1) - point(0), point(2) - point(0));
        CHECK(dot(twice, normal) == near(norm(twice), {.relative = 1e-12}));
        area += 0.5 * norm(twice);
    }
    for (const Vec3& p : mesh.points) CHECK(dot(p - center, normal) == near(0, {.absolute = 1e-12}));
    CHECK(area == near(std::numbers::pi * 0.05 * 0.05, {.relative = 2e-3}));
}

TEST_CASE("an obstacle needs a position at every step, and a point for every triangle corner") {
    const report::test::Robot robot = report::test::bent_bar(4, 1);
    Simulation s = robot.simulation();
    s.obstacles = {{"floor", disc({}, {0, 0, 1}, 0.1), true, std::vector<Vec3>(4)}};
    CHECK(check(s).error().message == "report: obstacle \"floor\" has 4 places, the result 5 steps");
    s.obstacles[0].offset_m.resize(5);
    CHECK(check(s));
    s.obstacles[0].surface.triangles.push_back({0, 1, 1000});
    CHECK_FALSE(check(s));
}
