#include "geometry/repair/surface_shells.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "geometry/repair/surface_check.hpp"

using namespace pliant;
using namespace pliant::mesh;

namespace {

/// Adds a tetrahedron with legs of length `leg` at `at`, oriented outwards, or inwards as a cavity.
void add(TriMesh& mesh, Vec3 at, double leg, bool outwards = true) {
    const int n = static_cast<int>(mesh.points.size());
    for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{leg, 0, 0}, Vec3{0, leg, 0}, Vec3{0, 0, leg}})
        mesh.points.push_back(at + p);
    for (std::array<int, 3> t : {std::array{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}) {
        if (!outwards) std::swap(t[0], t[1]);
        mesh.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
    }
}

std::string problem(const TriMesh& mesh) {
    const auto pieces = solid_pieces(mesh);
    return pieces ? "" : pieces.error().message;
}

}  // namespace

TEST_CASE("the winding number is 1 inside, 0 outside, -1 in a lone cavity") {
    TriMesh mesh;
    add(mesh, {0, 0, 0}, 6);
    CHECK(winding_number(mesh, {1, 1, 1}) == near(1, {.relative = 1e-12}));
    CHECK(winding_number(mesh, {3, 3, 3}) == near(0, {.absolute = 1e-12}));
    TriMesh cavity;
    add(cavity, {0, 0, 0}, 6, false);
    CHECK(winding_number(cavity, {1, 1, 1}) == near(-1, {.relative = 1e-12}));
}

TEST_CASE("cavities belong to the shell around them; islands in cavities are pieces of their own") {
    TriMesh mesh;
    add(mesh, {1, 1, 1}, 20, false);  // cavity of the first piece
    add(mesh, {0, 0, 0}, 60);
    add(mesh, {2, 2, 2}, 6);  // island in the cavity
    add(mesh, {100, 0, 0}, 6);
    const auto pieces = solid_pieces(mesh);
    REQUIRE_MESSAGE(pieces, (pieces ? "" : pieces.error().message));
    REQUIRE(pieces->size() == 3);
    CHECK(signed_volume((*pieces)[0]) == near((60.0 * 60 * 60 - 20.0 * 20 * 20) / 6, {.relative = 1e-12}));
    CHECK(signed_volume((*pieces)[1]) == near(36, {.relative = 1e-12}));
    CHECK(bounds((*pieces)[2]).low.x == 100);
    CHECK((*pieces)[0].points.size() == 8);
    for (const TriMesh& piece : *pieces) CHECK(check_closed(piece));
}

TEST_CASE("invalid shells are refused") {
    TriMesh twice;
    add(twice, {0, 0, 0}, 60);
    add(twice, {1, 1, 1}, 6);
    CHECK(problem(twice).find("inside the material of another") != std::string::npos);
    TriMesh loose;
    add(loose, {0, 0, 0}, 60);
    add(loose, {100, 0, 0}, 6, false);
    CHECK(problem(loose).find("inside out") != std::string::npos);
    TriMesh crowd;
    for (int i = 0; i <= 1000; ++i) add(crowd, {2.0 * i, 0, 0}, 1);
    CHECK(problem(crowd).find("1001 separate shells") != std::string::npos);
}
