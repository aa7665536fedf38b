#include "geometry/mesher/notches.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "base/core/near.hpp"
#include "geometry/mesh/test_shapes.hpp"
#include "geometry/mesher/mesher.hpp"

using namespace pliant;
using namespace pliant::mesh;
using namespace pliant::mesh::test;

namespace {

/// Volumes of the notches that a cable crosses in a body.
std::vector<double> volumes(const Solid& body, const std::vector<Vec3>& path) {
    const Result<TriMesh> surface = tessellate(body, 2e-3 * bounds(body).diagonal());
    REQUIRE(surface);
    std::vector<double> found;
    const Result<std::vector<Notch>> notches = crossed_notches(*surface, path);
    REQUIRE(notches);
    for (const Notch& notch : *notches) {
        const Result<double> volume = solid_volume(solid(NotchesSolid{{notch.hull}, {notch.point}, {body}}));
        REQUIRE_MESSAGE(volume, (volume ? "" : volume.error().message));
        found.push_back(*volume);
    }
    return found;
}

const Solid bar = box({0, 0, 0}, {40, 20, 15});
const std::vector<Vec3> cable = {{-5, 10, 13}, {40, 10, 13}};

}  // namespace

TEST_CASE("a V, box, half-round or skewed notch is filled up to its mouth and ends") {
    const Solid v = solid(PrismSolid{{{20, 5}, {25, 15}, {15, 15}}, {0, 2, 1}, 0, 20});
    const Solid u = box({18, -1, 5}, {22, 21, 16});
    const Solid round = solid(CylinderSolid{{20, -1, 15}, {20, 21, 15}, 6});
    const Solid skewed = solid(PrismSolid{{{20, 5}, {22, 5}, {33, 16}, {19, 16}}, {0, 2, 1}, -1, 21});
    const auto only = [](const std::vector<double>& found) {
        REQUIRE(found.size() == 1);
        return found[0];
    };
    CHECK(only(volumes(without(bar, v), cable)) == near(0.5 * 10 * 10 * 20, {.relative = 1e-12}));
    CHECK(only(volumes(without(bar, u), cable)) == near(4 * 10 * 20, {.relative = 1e-12}));
    CHECK(only(volumes(without(bar, round), cable)) == near(0.5 * std::numbers::pi * 36 * 20, {.relative = 1e-12}));
    const double top = (22.0 + 10) - (20 - 10.0 / 11);
    CHECK(only(volumes(without(bar, skewed), cable)) == near(0.5 * (2 + top) * 10 * 20, {.relative = 1e-12}));
}

TEST_CASE("a bore for the cable through the notches' flanks stays empty, and every notch is found once") {
    const Solid notch = solid(PrismSolid{{{10, 5}, {12, 15.1}, {8, 15.1}}, {0, 2, 1}, -1, 21});
    const Solid notches = solid(RepeatedSolid{notch, 3, {10, 0, 0}});
    const Solid bore = solid(CylinderSolid{{-1, 10, 13}, {41, 10, 13}, 0.5});
    const auto plain = volumes(without(bar, notches), cable);
    REQUIRE(plain.size() == 3);
    for (const double volume : plain) CHECK(volume == near(0.5 * 2 * (2.0 * 10 / 10.1) * 10 * 20, {.relative = 1e-12}));
    // Inside its bore the cable does not leave material: the flanks, and so the notches, are not found.
    CHECK(volumes(without(without(bar, notches), bore), cable).empty());
    const std::vector<Vec3> beside = {{-5, 4, 13}, {45, 4, 13}};
    const auto bored = volumes(without(without(bar, notches), bore), beside);
    REQUIRE(bored.size() == 3);
    CHECK(bored[1] == near(plain[1], {.relative = 1e-12}));
}

TEST_CASE("between a wide plate and a small block only the block's outline is filled") {
    const Solid plate = box({0, 0, 0}, {5, 100, 100});
    const Solid block = box({8, 40, 45}, {20, 50, 55});
    const Solid bridge = box({5, 40, 45}, {8, 50, 47});
    const Solid body = solid(CombinedSolid{CombinedSolid::Operation::unite, {plate, block, bridge}});
    const auto found = volumes(body, {{-1, 45, 51}, {20, 45, 51}});
    REQUIRE(found.size() == 1);
    CHECK(found[0] == near(3 * 10 * 8, {.relative = 1e-6}));
}
