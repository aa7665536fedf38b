#include "geometry/repair/surface_crossings.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"
#include "geometry/mesh/test_shapes.hpp"

using namespace pliant;
using namespace pliant::mesh;
using namespace pliant::mesh::test;

TEST_CASE("self-intersecting, coincident and touching surfaces are found; others are not") {
    const TriMesh one = cube({0, 0, 0}, 10);
    CHECK_FALSE(cuts_itself(one));
    CHECK_FALSE(cuts_itself(joined(one, cube({10.01, 0, 0}, 10))));
    CHECK_FALSE(cuts_itself(joined(one, cube({3, 3, 3}, 4))));  // a shell inside
    CHECK(cuts_itself(joined(one, cube({9, 9, 9}, 10))));
    CHECK(cuts_itself(joined(one, cube({10, 2, 2}, 5))));  // coplanar faces
    CHECK(cuts_itself(joined(one, cube({10, 3, 3}, 10))));
    TriMesh folded = one;
    folded.points.push_back({5, 5, 0});
    folded.points.push_back({5, 5, 1e-9});
    folded.triangles[0] = {0, 2, 8};
    folded.triangles.push_back({2, 1, 8});
    folded.triangles.push_back({1, 0, 9});
    folded.triangles.push_back({0, 8, 9});
    folded.triangles.push_back({8, 1, 9});
    CHECK(cuts_itself(folded));
}

TEST_CASE("the finest detail is the smallest triangle height over the size of the body") {
    CHECK(finest_detail(cube({1, 2, 3}, 10)) == near(1 / std::sqrt(2.0) / std::sqrt(3.0), {.relative = 1e-12}));
    TriMesh thin{{{0, 0, 0}, {4, 0, 0}, {2, 1e-3, 3}, {2, 1e-3, 0}}, {{0, 1, 2}, {0, 1, 3}}};
    CHECK(finest_detail(thin) == near(1e-3 / 5, {.relative = 1e-3}));
}
