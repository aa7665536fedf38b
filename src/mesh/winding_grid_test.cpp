#include "mesh/winding_grid.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "mesh/test_shapes.hpp"

using namespace pliant;
using namespace pliant::mesh;
using namespace pliant::mesh::test;

namespace {

/// A torus of m x n quads that winds `turns` times around its axis and so passes through itself where that is above 1.
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

/// Largest difference to the tree's number at random points in and around the box.
double largest_difference(const TriMesh& surface, int points) {
    const TriangleTree tree(surface);
    const WindingGrid grid(surface);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> share(-0.1, 1.1);
    const Box3 box = bounds(surface);
    const Vec3 size = box.size();
    double largest = 0;
    for (int i = 0; i < points; ++i) {
        const Vec3 p = box.low + Vec3{share(random) * size.x, share(random) * size.y, share(random) * size.z};
        largest = std::max(largest, std::fabs(grid.winding_number(p) - tree.winding_number(p)));
    }
    return largest;
}

/// What far triangles taken as dipoles do to the tree's number.
constexpr double dipoles = 0.1;

}  // namespace

TEST_CASE("winding grid: whole numbers, and those of the tree") {
    CHECK(largest_difference(cube(), 20000) < dipoles);
    CHECK(largest_difference(joined(cube(), cube({5, 0, 0})), 20000) < dipoles);
    CHECK(largest_difference(joined(cube(), turned_inside_out(cube({2, 2, 2}, 5))), 20000) < dipoles);
    CHECK(largest_difference(torus(60, 30, 1), 20000) < dipoles);
    CHECK(largest_difference(torus(90, 20, 3), 20000) < dipoles);
    CHECK(largest_difference(turned_inside_out(torus(90, 20, 2)), 20000) < dipoles);
    const WindingGrid twice(joined(cube(), cube({5, 0, 0})));
    CHECK(twice.winding_number({7, 5, 5}) == 2);
    CHECK(twice.winding_number({2, 5, 5}) == 1);
    CHECK(twice.winding_number({2, 5, 50}) == 0);
    CHECK(twice.winding_number({16, 5, 5}) == 0);
}

TEST_CASE("winding grid: close to faces, edges and corners, on both sides") {
    const WindingGrid grid(joined(cube(), cube({20, 0, 0})));
    for (const double depth : {1e-3, 1e-6, 1e-9}) {
        for (const Vec3& out : {Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{1, 1, 1}, Vec3{0, 0, 1}}) {
            const Vec3 at{out.x == 0 ? 2.5 : 10, out.y == 0 ? 5.0 : 10, out.z == 0 ? 7.5 : 10};
            CHECK(grid.winding_number(at - depth * out) == doctest::Approx(1).scale(0));
            CHECK(std::fabs(grid.winding_number(at + depth * out)) < 1e-9);
        }
    }
}

TEST_CASE("winding grid: a surface with a border is the tree's") {
    TriMesh open = cube();
    open.triangles.pop_back();
    const WindingGrid grid(open);
    const TriangleTree tree(open);
    for (const Vec3& p : {Vec3{5, 5, 5}, Vec3{9, 5, 5}, Vec3{12, 5, 5}, Vec3{-3, 2, 2}})
        CHECK(grid.winding_number(p) == tree.winding_number(p));
    CHECK(WindingGrid(TriMesh{}).winding_number({0, 0, 0}) == 0);
}

TEST_CASE("winding grid: much detail in a corner, and a surface without volume") {
    TriMesh fine = torus(200, 100, 1);
    for (Vec3& p : fine.points) p = 1e-3 * p;
    CHECK(largest_difference(joined(cube({50, 50, 50}), fine), 5000) < dipoles);
    TriMesh flat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
    CHECK(WindingGrid(flat).winding_number({0.2, 0.2, 0}) == doctest::Approx(0).scale(1));
    CHECK(WindingGrid(flat).winding_number({0.2, 0.2, 0.1}) == 0);
}
