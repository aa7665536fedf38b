#include "geometry/repair/surface_seams.hpp"

#include <doctest/doctest.h>

#include <memory>

#include "base/core/near.hpp"
#include "geometry/mesh/test_shapes.hpp"
#include "geometry/repair/surface_check.hpp"

using namespace pliant;
using namespace pliant::mesh;
using namespace pliant::mesh::test;

namespace {

/// A triangle soup without shared points, each point moved by up to `by`.
TriMesh torn(const TriMesh& surface, double by) {
    TriMesh result;
    int count = 0;
    for (const auto& t : surface.triangles) {
        for (const int corner : t) {
            const double aside = by * ((count * 7 % 11) / 5.0 - 1);
            result.points.push_back(surface.points[static_cast<std::size_t>(corner)] + Vec3{aside, -aside / 2, 0});
            ++count;
        }
        result.triangles.push_back({count - 3, count - 2, count - 1});
    }
    return result;
}

}  // namespace

TEST_CASE("seams: points that differ by rounding are joined, others are not") {
    TriMesh fine = torn(cube(), 2e-6);
    CHECK(border_edges(fine).size() == 36);
    CHECK(close_seams(fine).edges == 36);
    CHECK(check_closed(fine).has_value());
    CHECK(signed_volume(fine) == near(1000, {.relative = 1e-5}));
    TriMesh wide = torn(cube(), 1e-3);
    CHECK(close_seams(wide).edges == 0);
    CHECK(wide.points.size() == 36);
}

TEST_CASE("seams: a closed surface and a real hole stay as they are") {
    TriMesh whole = cube();
    CHECK(border_edges(whole).empty());
    CHECK(close_seams(whole).edges == 0);
    TriMesh holed = cube();
    holed.triangles.pop_back();
    CHECK(border_edges(holed).size() == 3);
    CHECK(close_seams(holed).edges == 0);
    CHECK(holed.triangles.size() == 11);
    CHECK(close_seams(*std::make_unique<TriMesh>()).edges == 0);
}

TEST_CASE("seams: a degenerate triangle is dropped") {
    TriMesh split = cube();
    // The edge from corner 1 to corner 3 gets a point beside corner 3, with a sliver on one side only.
    split.points.push_back(split.points[3] + Vec3{0, -1e-6, 0});
    split.triangles[1] = {1, 2, 8};
    split.triangles.push_back({8, 2, 3});
    split.triangles[11] = {3, 7, 5};
    CHECK_FALSE(border_edges(split).empty());
    CHECK(close_seams(split).edges == 3);
    CHECK(check_closed(split).has_value());
    CHECK(split.triangles.size() == 12);
}
