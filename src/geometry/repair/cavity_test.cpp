#include "geometry/repair/cavity.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "geometry/mesher/mesher.hpp"

using namespace pliant;
using namespace pliant::mesh;

namespace {

Solid node(auto shape) {
    return std::make_shared<const SolidNode>(SolidNode{std::move(shape)});
}

/// A cube of side 10 with two rooms, one open to the outside by a shaft if asked for, in two bodies that touch.
TetMesh house(bool with_shaft) {
    std::vector<Solid> parts = {node(BoxSolid{{0, 0, 0}, {10, 10, 10}}), node(BoxSolid{{1, 1, 1}, {4, 9, 9}}),
                                node(BoxSolid{{6, 2, 2}, {8, 8, 8}})};
    if (with_shaft) parts.push_back(node(BoxSolid{{6, 4, 4}, {11, 6, 6}}));
    const Solid all = node(CombinedSolid{CombinedSolid::Operation::subtract, parts});
    const auto half = [&](double from, double to) {
        return node(
            CombinedSolid{CombinedSolid::Operation::intersect, {all, node(BoxSolid{{0, 0, from}, {10, 10, to}})}});
    };
    Progress silent;
    const std::vector<BodyGeometry> bodies = {{"lower", half(0, 5)}, {"upper", half(5, 10)}};
    const Result<TetMesh> mesh = mesh_bodies(bodies, {.size = 3, .order = 2}, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    return *mesh;
}

/// Volume that the faces enclose, normals inwards.
double enclosed(const TetMesh& mesh, const std::vector<Face>& faces) {
    TriMesh surface{mesh.points, {}};
    for (const Face& face : faces) surface.triangles.push_back({face.nodes[0], face.nodes[1], face.nodes[2]});
    return -signed_volume(surface);
}

}  // namespace

TEST_CASE("the cavity around a point is found, with walls of several bodies") {
    const TetMesh mesh = house(false);
    const auto big = cavity_faces(mesh, {2, 5, 5});
    REQUIRE_MESSAGE(big, (big ? "" : big.error().message));
    CHECK(enclosed(mesh, *big) == near(3 * 64, {.relative = 1e-12}));
    const auto small = cavity_faces(mesh, {7, 3, 7});
    REQUIRE(small);
    CHECK(enclosed(mesh, *small) == near(2 * 36, {.relative = 1e-12}));
}

TEST_CASE("bodies that float in a cavity bound it too, and their own cavities do not") {
    const auto box = [](double low, double high) { return node(BoxSolid{{low, low, low}, {high, high, high}}); };
    const auto hollow = [&](double low, double high, double from, double to) {
        return node(CombinedSolid{CombinedSolid::Operation::subtract, {box(low, high), box(from, to)}});
    };
    // One in the other: walls of 1, gaps of 1, and a core of 2.
    const std::vector<BodyGeometry> bodies = {
        {"shell", hollow(0, 10, 1, 9)}, {"ball", hollow(2, 8, 3, 7)}, {"core", box(4, 6)}};
    Progress silent;
    const Result<TetMesh> mesh = mesh_bodies(bodies, {.size = 3, .order = 1}, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    const auto outer = cavity_faces(*mesh, {1.5, 5, 5});
    REQUIRE_MESSAGE(outer, (outer ? "" : outer.error().message));
    CHECK(enclosed(*mesh, *outer) == near(512 - 216, {.relative = 1e-12}));
    const auto inner = cavity_faces(*mesh, {3.5, 5, 5});
    REQUIRE(inner);
    CHECK(enclosed(*mesh, *inner) == near(64 - 8, {.relative = 1e-12}));
    CHECK(cavity_faces(*mesh, {5, 5, 5}).error().message.find("in the material") != std::string::npos);
    CHECK(enclosed(*mesh, faces_from_outside(*mesh)) == near(-1000, {.relative = 1e-12}));
}

TEST_CASE("closed cavities cannot be reached from outside, open ones can") {
    const TetMesh closed = house(false), open = house(true);
    CHECK(enclosed(closed, faces_from_outside(closed)) == near(-1000, {.relative = 1e-12}));
    const double shaft = 2 * 4;  // between the room and the outside
    CHECK(enclosed(open, faces_from_outside(open)) == near(-1000 + 2 * 36 + shaft, {.relative = 1e-12}));
}

TEST_CASE("a point in material, outside, or in an open space is refused") {
    CHECK(cavity_faces(house(false), {0.5, 5, 5}).error().message.find("in the material") != std::string::npos);
    CHECK(cavity_faces(house(false), {50, 5, 5}).error().message.find("no closed cavity") != std::string::npos);
    const TetMesh open = house(true);
    CHECK(cavity_faces(open, {7, 5, 5}).error().message.find("open to the outside") != std::string::npos);
    CHECK(cavity_faces(open, {2, 5, 5}));
}
