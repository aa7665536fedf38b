#include "geometry/repair/split_edges.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <span>

#include "base/core/near.hpp"
#include "geometry/mesh/test_shapes.hpp"
#include "geometry/repair/surface_check.hpp"

using namespace pliant;

namespace {

/// From the origin, `length` along x and 1 along the others: 12 triangles.
mesh::TriMesh bar(double length) {
    mesh::TriMesh bar = mesh::test::cube({0, 0, 0}, 1);
    for (Vec3& p : bar.points) p.x *= length;
    return bar;
}

double longest_edge(const mesh::TriMesh& surface) {
    double longest = 0;
    for (const auto& t : surface.triangles) {
        for (std::size_t k = 0; k < 3; ++k)
            longest = std::max(longest, norm(surface.points[static_cast<std::size_t>(t[k])] -
                                             surface.points[static_cast<std::size_t>(t[(k + 1) % 3])]));
    }
    return longest;
}

}  // namespace

TEST_CASE("a surface with short edges is the same closed surface") {
    const mesh::TriMesh box = bar(4);
    const mesh::TriMesh fine = mesh::with_short_edges(box, [](const Vec3&) { return 0.3; });
    CHECK(longest_edge(fine) <= 0.3);
    CHECK(mesh::check_closed(fine));
    CHECK(mesh::signed_volume(fine) == near(4, {.relative = 1e-12}));
    REQUIRE(fine.points.size() > box.points.size());
    CHECK(std::ranges::equal(box.points, std::span(fine.points).first(box.points.size())));
    CHECK(fine.triangles.size() < 18 * 8 / (0.3 * 0.3));
}

TEST_CASE("edges are as short as asked where that is") {
    const mesh::TriMesh box = bar(8);
    const auto longest = [](const Vec3& p) { return p.x < 2 ? 0.2 : 2.0; };
    const mesh::TriMesh fine = mesh::with_short_edges(box, longest);
    CHECK(mesh::check_closed(fine));
    const auto at_end = std::ranges::count_if(fine.points, [](const Vec3& p) { return p.x > 6; });
    const auto at_start = std::ranges::count_if(fine.points, [](const Vec3& p) { return p.x < 2; });
    CHECK(at_start > 10 * at_end);
}

TEST_CASE("a surface with short edges, and one with too many triangles, are left as they are") {
    const mesh::TriMesh box = bar(1);
    CHECK(mesh::with_short_edges(box, [](const Vec3&) { return 2.0; }).triangles == box.triangles);
    CHECK(mesh::with_short_edges(
              box, [](const Vec3&) { return 0.0; }, 12)
              .triangles == box.triangles);
}
