#include "geometry/meshing/winding_grid.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "base/core/near.hpp"
#include "geometry/mesh/test_shapes.hpp"

using namespace pliant;
using namespace pliant::mesh;
using namespace pliant::mesh::test;

namespace {

/// A torus of m x n quads that winds `turns` times around its axis; if above 1, it intersects itself.
TriMesh torus(int m, int n, int turns) {
    TriMesh mesh;
    for (int i = 0; i < m; ++i) {
        for (int j = 0; j < n; ++j) {
            const double u = 2 * std::numbers::pi * i / m;
            const double v = 2 * std::numbers::pi * j / n;
            const double r = 10 + 2 * std::cos(u) + (3 + std::sin(u)) * std::cos(v);
            mesh.points.push_back({r * std::cos(turns * u), r * std::sin(turns * u), 3 * std::sin(v)});
            const auto at = [&](int a, int b) { return (a % m) * n + b % n; };
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return mesh;
}

TriMesh turned_inside_out(TriMesh mesh) {
    for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
    return mesh;
}

/// By summing the solid angles of all triangles (van Oosterom and Strackee 1983).
double exact_winding_number(const TriMesh& surface, const Vec3& point) {
    double halves = 0;
    for (const auto& t : surface.triangles) {
        const auto from_point = [&](int n) { return surface.points[static_cast<std::size_t>(n)] - point; };
        const Vec3 a = from_point(t[0]);
        const Vec3 b = from_point(t[1]);
        const Vec3 c = from_point(t[2]);
        halves += std::atan2(dot(a, cross(b, c)), norm(a) * norm(b) * norm(c) + dot(a, b) * norm(c) +
                                                      dot(b, c) * norm(a) + dot(c, a) * norm(b));
    }
    return halves / (2 * std::numbers::pi);
}

/// Largest error at random points in and around the box.
double largest_error(const TriMesh& surface, int points) {
    const WindingGrid grid(surface);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> share(-0.1, 1.1);
    const Box3 box = bounds(surface);
    const Vec3 size = box.size();
    double largest = 0;
    for (int i = 0; i < points; ++i) {
        const Vec3 p = box.low + Vec3{share(random) * size.x, share(random) * size.y, share(random) * size.z};
        largest = std::max(largest, std::fabs(grid.winding_number(p) - exact_winding_number(surface, p)));
    }
    return largest;
}

/// Allowed error from treating distant triangles as dipoles, if there is a border.
constexpr double dipoles = 0.1;
constexpr double rounding = 1e-9;

}  // namespace

TEST_CASE("winding grid: values are whole numbers for closed surfaces") {
    CHECK(largest_error(cube(), 20000) < rounding);
    CHECK(largest_error(joined(cube(), cube({5, 0, 0})), 20000) < rounding);
    CHECK(largest_error(joined(cube(), turned_inside_out(cube({2, 2, 2}, 5))), 20000) < rounding);
    CHECK(largest_error(torus(60, 30, 1), 3000) < rounding);
    CHECK(largest_error(torus(90, 20, 3), 3000) < rounding);
    CHECK(largest_error(turned_inside_out(torus(90, 20, 2)), 3000) < rounding);
    const WindingGrid twice(joined(cube(), cube({5, 0, 0})));
    CHECK(twice.winding_number({7, 5, 5}) == 2);
    CHECK(twice.winding_number({2, 5, 5}) == 1);
    CHECK(twice.winding_number({2, 5, 50}) == 0);
    CHECK(twice.winding_number({16, 5, 5}) == 0);
}

TEST_CASE("winding grid: correct close to faces, edges and corners, on both sides") {
    const WindingGrid grid(joined(cube(), cube({20, 0, 0})));
    for (const double depth : {1e-3, 1e-6, 1e-9}) {
        for (const Vec3& out : {Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{1, 1, 1}, Vec3{0, 0, 1}}) {
            const Vec3 at{out.x == 0 ? 2.5 : 10, out.y == 0 ? 5.0 : 10, out.z == 0 ? 7.5 : 10};
            CHECK(grid.winding_number(at - depth * out) == near(1, {.relative = 1e-12}));
            CHECK(std::fabs(grid.winding_number(at + depth * out)) < 1e-9);
        }
    }
}

TEST_CASE("winding grid: a surface with a border gives halves and quarters") {
    TriMesh lidless = cube();
    std::erase_if(lidless.triangles, [&](const auto& t) {
        return std::all_of(t.begin(), t.end(),
                           [&](int n) { return lidless.points[static_cast<std::size_t>(n)].z == 10; });
    });
    REQUIRE(lidless.triangles.size() == 10);
    const WindingGrid grid(lidless);
    CHECK(grid.winding_number({5, 5, 5}) == near(5.0 / 6, {.relative = 1e-12}));
    CHECK(grid.winding_number({5, 5, 10}) == near(0.5, {.relative = 1e-12}));
    CHECK(grid.winding_number({5, 5, 1e-6}) - grid.winding_number({5, 5, -1e-6}) == near(1, {.relative = 1e-5}));
    CHECK(WindingGrid(TriMesh{}).winding_number({0, 0, 0}) == 0);
}

TEST_CASE("winding grid: holes, repeated and flipped triangles, and a surface of borders only") {
    const auto without = [](TriMesh mesh, std::size_t every) {
        std::size_t i = 0;
        std::erase_if(mesh.triangles, [&](const auto&) { return ++i % every == 0; });
        return mesh;
    };
    CHECK(largest_error(without(torus(60, 30, 1), 300), 3000) < dipoles);
    CHECK(largest_error(without(torus(60, 30, 1), 3), 1000) < dipoles);
    CHECK(largest_error(without(torus(90, 20, 3), 500), 3000) < dipoles);
    TriMesh doubled = torus(60, 30, 1);
    doubled.triangles.push_back(doubled.triangles[77]);
    std::swap(doubled.triangles[500][0], doubled.triangles[500][1]);
    CHECK(largest_error(doubled, 3000) < dipoles);
    TriMesh soup;
    const TriMesh whole = torus(20, 10, 1);
    for (const auto& t : whole.triangles) {
        for (const int n : t) soup.points.push_back(whole.points[static_cast<std::size_t>(n)]);
        const int first = static_cast<int>(soup.points.size()) - 3;
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    CHECK(largest_error(soup, 1000) < dipoles);
}

TEST_CASE("winding grid: fine detail in one corner, and a surface without volume") {
    TriMesh fine = torus(200, 100, 1);
    for (Vec3& p : fine.points) p = 1e-3 * p;
    CHECK(largest_error(joined(cube({50, 50, 50}), fine), 1000) < dipoles);
    TriMesh flat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
    CHECK(WindingGrid(flat).winding_number({0.2, 0.2, 0}) == near(0, {.absolute = 1e-12}));
    CHECK(WindingGrid(flat).winding_number({0.2, 0.2, 0.1}) == 0);
}
