#include "geometry/shapes/sphere_surface.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::mesh;

TEST_CASE("a sphere becomes a closed polyhedron within the tolerance, normals outwards") {
    const SphereSolid sphere{{1, -2, 3}, 4};
    for (const double tolerance : {1.0, 1e-1, 1e-2, 1e-3}) {
        const TriMesh surface = sphere_surface(sphere, tolerance);
        std::map<std::pair<int, int>, int> uses;
        double farthest = 0;
        for (const auto& t : surface.triangles) {
            for (std::size_t k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
            const Vec3 a = surface.points[t[0]], n = cross(surface.points[t[1]] - a, surface.points[t[2]] - a);
            farthest = std::max(farthest, sphere.radius - dot(unit(n), a - sphere.center));
        }
        for (const auto& [edge, count] : uses) {
            REQUIRE(count == 1);
            REQUIRE(uses.contains({edge.second, edge.first}));
        }
        for (const Vec3& p : surface.points) CHECK(norm(p - sphere.center) == near(4, {.relative = 1e-14}));
        CHECK(farthest <= tolerance);
        CHECK(farthest > 0.2 * tolerance);  // no more triangles than needed: from one part to two is four times as near
        CHECK(signed_volume(surface) < 4.0 / 3 * std::numbers::pi * 64);
        CHECK(signed_volume(surface) > 4.0 / 3 * std::numbers::pi * 64 - 4 * std::numbers::pi * 16 * tolerance);
    }
}
