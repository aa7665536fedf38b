// Chambers that a support closes: the air presses on the support, not on the robot.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include "base/core/near.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;
using robot::testing::build_text;
using robot::testing::last_step;

namespace {

constexpr double pressure_Pa = 50e3;

/// A bar of 30 mm with a channel of 4 by 4 mm that ends at the first support. `flange`: what that support holds.
std::string open_bar(int order, double size_mm, const std::string& flange) {
    return fmt::format(R"(
name = "open bar"
length_unit = "mm"
[material.rubber]
youngs_modulus = "1 MPa"
poisson_ratio = 0.45
[[body]]
name = "bar"
material = "rubber"
geometry = {{ box = [[0, 0, 0], [30, 10, 10]] }}
[mesh]
size = "{} mm"
order = {}
[[fixed]]
name = "flange"
box = [[0, 0, 0], [0, 10, 10]]
{}
[[chamber]]
name = "air"
geometry = {{ box = [[0, 3, 3], [20, 7, 7]] }}
target = {{ pressure = "50 kPa" }}
[program]
steps = 2
tolerance = 1e-7
)",
                       size_mm, order, flange);
}

/// Area of the mouth, m^2, from the positions of its faces' corners: that of a polygon depends on its rim alone.
double mouth_area(const robot::testing::Built& built, const sim::Step& step) {
    const sim::Wall& wall = built.model.description().chambers[0].wall;
    REQUIRE(wall.mouth_faces > 0);
    std::vector<double> x;
    for (const Vec3& p : step.positions) x.insert(x.end(), {p.x, p.y, p.z});
    double area = 0;
    const auto triangle = [&](int i, int j, int k) {
        const auto at = [&](int point) { return sim::position(wall.points[static_cast<std::size_t>(point)], x); };
        area += 0.5 * cross(at(j) - at(i), at(k) - at(i)).x;
    };
    for (std::size_t f = wall.faces.size() - wall.mouth_faces; f < wall.faces.size(); ++f) {
        const auto& n = wall.faces[f];
        triangle(n[0], n[1], n[2]);
        if (n[3] < 0) continue;  // between the chords of its curved sides
        const auto bulge = [&](int from, int middle, int to) {
            const double before = area;
            triangle(from, middle, to);
            area = before + 4.0 / 3 * (area - before);
        };
        bulge(n[0], n[3], n[1]);
        bulge(n[1], n[4], n[2]);
        bulge(n[2], n[5], n[0]);
    }
    return std::abs(area);
}

}  // namespace

TEST_CASE("a support that closes a chamber holds the robot against the air, on any mesh") {
    for (const int order : {1, 2}) {
        for (const double size_mm : {10.0, 3.0}) {
            CAPTURE(order);
            CAPTURE(size_mm);
            const sim::Step step = last_step(build_text(open_bar(order, size_mm, "")));
            CHECK(step.supports[0].force_N.x == near(-pressure_Pa * 16e-6, {.relative = 1e-5}));
            CHECK(norm(Vec3{0, step.supports[0].force_N.y, step.supports[0].force_N.z}) < 1e-5);
        }
    }
}

TEST_CASE("where the mouth slides on its support, the force is that on its present area") {
    const std::string sliding = "directions = [[1, 0, 0]]\n[[fixed]]\nname = \"end\"\nbox = [[30, 0, 0], [30, 10, 10]]";
    for (const int order : {1, 2}) {
        CAPTURE(order);
        const robot::testing::Built built = build_text(open_bar(order, 4, sliding));
        const sim::Step step = last_step(built);
        const double area = mouth_area(built, step);
        CHECK(area > 16.2e-6);
        CHECK(step.supports[0].force_N.x + step.supports[1].force_N.x == near(-pressure_Pa * area, {.relative = 1e-5}));
    }
}
