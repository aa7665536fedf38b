#include "geometry/shapes/rod_surface.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::mesh;

namespace {

template <class Shape>
Solid drawn(Shape shape) {
    return std::make_shared<const SolidNode>(SolidNode{std::move(shape)});
}

/// Each edge is used once in each direction.
bool is_closed(const TriMesh& surface) {
    std::map<std::pair<int, int>, int> uses;
    for (const auto& t : surface.triangles)
        for (std::size_t k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
    for (const auto& [edge, count] : uses)
        if (count != 1 || uses[{edge.second, edge.first}] != 1) return false;
    return true;
}

}  // namespace

TEST_CASE("a cylinder becomes a closed prism within the tolerance, normals outwards, wherever it is placed") {
    const Solid rod = drawn(CylinderSolid{{1, 2, 3}, {1, 6, 6}, 2});
    const Solid placed = drawn(RotatedSolid{drawn(TranslatedSolid{rod, {0, 0, 4}}), {1, 0, 0}, {0, 0, 2}, 0.7});
    for (const Solid& s : {rod, placed}) {
        for (const double tolerance : {1e-1, 1e-2, 1e-4}) {
            const auto surface = rod_surface(s, tolerance);
            REQUIRE(surface);
            CHECK(is_closed(*surface));
            const double exact = 5 * std::numbers::pi * 4;
            CHECK(signed_volume(*surface) < exact);
            // A ring as thick as the tolerance holds what a prism lacks.
            CHECK(signed_volume(*surface) > exact - 5 * 2 * std::numbers::pi * 2 * tolerance);
            for (const Vec3& p : surface->points) CHECK(bounds(s).contains(p, 1e-12));
        }
    }
    CHECK(rod_surface(rod, 10)->triangles.size() == 4 * 24);
    CHECK(rod_surface(rod, 1e-9)->triangles.size() == 4 * 2000);
}

TEST_CASE("only a single cylinder is a rod") {
    CHECK_FALSE(rod_surface(drawn(BoxSolid{{0, 0, 0}, {1, 1, 1}}), 0.1));
    const Solid rod = drawn(CylinderSolid{{0, 0, 0}, {0, 0, 1}, 1});
    CHECK_FALSE(rod_surface(drawn(RepeatedSolid{rod, 2, {3, 0, 0}}), 0.1));
}
