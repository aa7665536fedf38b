#include "simulation/contact/obstacle_inset.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::sim::contact;

namespace {

/// Two triangles a side, split along diagonals of which some meet in a corner and some do not.
mesh::TriMesh box(const Vec3& size) {
    mesh::TriMesh m;
    for (int k = 0; k < 8; ++k) m.points.push_back({k & 1 ? size.x : 0, k & 2 ? size.y : 0, k & 4 ? size.z : 0});
    m.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return m;
}

/// An octahedron, its triangles divided and thrown onto the sphere.
mesh::TriMesh ball(double radius, int divisions) {
    mesh::TriMesh m{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                    {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
    for (int d = 0; d < divisions; ++d) {
        std::vector<std::array<int, 3>> finer;
        const auto middle = [&](int a, int b) {
            const Vec3 p = m.points[a] + m.points[b];
            const auto at = std::find_if(m.points.begin(), m.points.end(),
                                         [&](const Vec3& q) { return norm(q - p / norm(p)) < 1e-9; });
            const auto index = static_cast<int>(at - m.points.begin());
            if (at == m.points.end()) m.points.push_back(p / norm(p));
            return index;
        };
        for (const auto& t : m.triangles) {
            const int a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
            finer.insert(finer.end(), {{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}});
        }
        m.triangles = std::move(finer);
    }
    return mesh::scaled(std::move(m), radius);
}

}  // namespace

TEST_CASE("every side of a box moves in by the depth, however its faces are triangulated") {
    const auto points = inset(box({3, 2, 1}), 0.1);
    REQUIRE(points);
    for (int k = 0; k < 8; ++k) {
        const Vec3 wanted{k & 1 ? 2.9 : 0.1, k & 2 ? 1.9 : 0.1, k & 4 ? 0.9 : 0.1};
        CHECK(norm((*points)[k] - wanted) < 1e-12);
    }
}

TEST_CASE("a ball's radius shrinks by the depth") {
    const auto points = inset(ball(10, 3), 0.5);
    REQUIRE(points);
    for (const Vec3& p : *points) CHECK(norm(p) == near(9.5, {.relative = 1e-3}));
}

TEST_CASE("open, inverted and too thin obstacles are not changed") {
    mesh::TriMesh open = box({1, 1, 1});
    open.triangles.pop_back();
    CHECK_FALSE(inset(open, 0.01));
    mesh::TriMesh turned = box({1, 1, 1});
    for (auto& t : turned.triangles) std::swap(t[0], t[1]);
    CHECK_FALSE(inset(turned, 0.01));
    CHECK_FALSE(inset(box({1, 1, 0.01}), 0.006));
    CHECK(inset(box({1, 1, 0.01}), 0.004));
}
