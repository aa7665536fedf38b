// Surfaces of drawn solids as equations.
#include "geometry/shapes/surface_pieces.hpp"

#include <doctest/doctest.h>

#include <memory>
#include <numbers>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::mesh;

namespace {

template <class Shape>
Solid solid(Shape shape) {
    return std::make_shared<const SolidNode>(SolidNode{std::move(shape)});
}

/// Number of pieces that contain a point.
int count_at(const Solid& of, const Vec3& p) {
    int count = 0;
    for (const SurfacePiece& piece : surface_pieces(of)) count += piece.holds(p, 1e-9) ? 1 : 0;
    return count;
}

}  // namespace

TEST_CASE("a box has six faces; two meet at an edge, three at a corner") {
    const Solid box = solid(BoxSolid{{0, 0, 0}, {4, 3, 2}});
    CHECK(surface_pieces(box).size() == 6);
    CHECK(count_at(box, {1, 1, 2}) == 1);
    CHECK(count_at(box, {4, 1, 2}) == 2);
    CHECK(count_at(box, {4, 3, 2}) == 3);
    CHECK(count_at(box, {1, 1, 1}) == 0);
    CHECK(count_at(box, {5, 1, 2}) == 0);  // on the plane of a face, beside it
    for (const SurfacePiece& piece : surface_pieces(box)) CHECK(norm(piece.direction) == near(1, {.relative = 1e-14}));
}

TEST_CASE("round surfaces know their distance and normal, and end at their caps") {
    const Solid can = solid(CylinderSolid{{0, 0, 0}, {0, 0, 5}, 2});
    CHECK(count_at(can, {2, 0, 1}) == 1);
    CHECK(count_at(can, {0, 2, 5}) == 2);
    CHECK(count_at(can, {1, 0, 5}) == 1);
    CHECK(count_at(can, {2, 0, 6}) == 0);
    CHECK(count_at(can, {3, 0, 5}) == 0);
    const SurfacePiece side = surface_pieces(can)[0];
    CHECK(side.distance({3, 4, 1}) == near(3, {.relative = 1e-14}));
    CHECK(norm(side.normal({0, 7, 1}) - Vec3{0, 1, 0}) < 1e-14);
    const Solid ball = solid(SphereSolid{{1, 2, 3}, 2});
    CHECK(count_at(ball, {1, 2, 5}) == 1);
    CHECK(surface_pieces(ball)[0].distance({1, 2, 8}) == near(3, {.relative = 1e-14}));
    CHECK(norm(surface_pieces(ball)[0].normal({1, 9, 3}) - Vec3{0, 1, 0}) < 1e-14);
}

TEST_CASE("faces of a non-convex prism end at its outline") {
    const Solid ell = solid(PrismSolid{{{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 3}, {0, 3}}, {0, 2, 1}, 0, 2});
    CHECK(surface_pieces(ell).size() == 8);
    CHECK(count_at(ell, {0.5, 0, 2}) == 1);
    CHECK(count_at(ell, {3, 0, 2}) == 0);  // in the notch
    CHECK(count_at(ell, {1, 1, 2}) == 1);  // on the inner wall
    CHECK(count_at(ell, {1, 0, 1}) == 3);  // in the inner corner of a cap
}

TEST_CASE("surfaces are turned, moved and repeated with their solids") {
    const Solid box = solid(BoxSolid{{0, 0, 0}, {2, 1, 1}});
    const Solid turned = solid(RotatedSolid{box, {0, 0, 0}, {0, 0, 1}, std::numbers::pi / 2});
    CHECK(count_at(turned, {-1, 1, 0.5}) == 1);
    CHECK(count_at(turned, {-0.5, 2, 0.5}) == 1);
    CHECK(count_at(turned, {2, 0.5, 0.5}) == 0);
    const Solid far = solid(TranslatedSolid{turned, {10, 0, 0}});
    CHECK(count_at(far, {9, 1, 0.5}) == 1);
    const Solid row = solid(RepeatedSolid{box, 3, {5, 0, 0}});
    CHECK(surface_pieces(row).size() == 18);
    CHECK(count_at(row, {12, 0.5, 0.5}) == 1);
    const Solid both = solid(CombinedSolid{CombinedSolid::Operation::subtract, {box, far}});
    CHECK(surface_pieces(both).size() == 12);
}
