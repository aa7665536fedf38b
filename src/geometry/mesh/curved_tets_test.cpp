#include "geometry/mesh/curved_tets.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "geometry/mesh/test_tets.hpp"

using namespace pliant;
using namespace pliant::mesh;

namespace {

TetMesh two_quadratic_tets() {
    return to_quadratic(mesh::test::two_tets());
}

}  // namespace

TEST_CASE("a straight tet has a constant Jacobian") {
    const TetMesh mesh = two_quadratic_tets();
    for (std::size_t t = 0; t < 2; ++t) CHECK(worst_scaled_jacobian(mesh, t) == near(1, {.relative = 1e-12}));
}

TEST_CASE("the Jacobian of a tet with one moved mid-edge node") {
    TetMesh mesh = two_quadratic_tets();
    // Node 4 of tet 0 is the middle of its edge 0-1 along x. With x = b1 + 4 d b0 b1 the determinant is dx/db1 =
    // 1 + 4 d (b0 - b1) where b0 = 1 - b1: between 1 - 4 d and 1 + 4 d.
    mesh.points[mesh.nodes[4]].x += 0.1;
    CHECK(worst_scaled_jacobian(mesh, 0) == near(1 - 0.4, {.relative = 1e-12}));
    CHECK(worst_scaled_jacobian(mesh, 1) == near(1, {.relative = 1e-12}));
    mesh.points[mesh.nodes[4]].x += 0.3;
    CHECK(worst_scaled_jacobian(mesh, 0) == near(1 - 1.6, {.relative = 1e-12}));
}

TEST_CASE("only folded tets are straightened") {
    TetMesh mesh = two_quadratic_tets();
    const int folded = mesh.nodes[4];
    const int curved = mesh.nodes[10 + 7];  // on edge 0-3 of the second tet, away from the first
    mesh.points[folded].x += 0.4;
    mesh.points[curved] += Vec3{0.02, 0, 0};
    const Vec3 kept = mesh.points[curved];
    CHECK(straighten_folded_tets(mesh, 0.1) == 1);
    CHECK(mesh.points[folded] == Vec3{0.5, 0, 0});
    CHECK(mesh.points[curved] == kept);
    CHECK(straighten_folded_tets(mesh, 0.1) == 0);
}
