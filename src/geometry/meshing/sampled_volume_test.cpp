#include "geometry/meshing/sampled_volume.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/core/near.hpp"
#include "geometry/mesh/test_shapes.hpp"

using namespace pliant;
using namespace pliant::mesh;
using namespace pliant::mesh::test;
using namespace pliant::mesh::kernel;

TEST_CASE("what others cover of a solid is counted once, and only inside it") {
    const Solid block = box({0, 0, 0}, {10, 10, 10});
    // Two that share 2 x 4 x 4, one half outside, one apart.
    const std::vector<Solid> others = {box({1, 1, 1}, {5, 5, 5}), box({3, 1, 1}, {7, 5, 5}),
                                       box({8, 8, 8}, {12, 12, 12}), box({20, 0, 0}, {30, 9, 9})};
    const SampledVolume found = covered_volume(block, others, 4000);
    CHECK(found.volume == near(64 + 32 + 8, {.relative = 0.01}));
    CHECK(found.deviation > 0);
    CHECK(found.deviation < 2);
    const SampledVolume again = covered_volume(block, others, 4000);
    CHECK(again.volume == found.volume);
}

TEST_CASE("the volume that parts have in common is counted for all but the first of them") {
    const Solid ball = solid(SphereSolid{{0, 0, 0}, 2});
    const std::vector<Solid> same = {ball, ball, ball};
    CHECK(repeated_volume(same, 4000).volume == near(2 * 4.0 / 3 * std::numbers::pi * 8, {.relative = 0.01}));
    const std::vector<Solid> touching = {ball, solid(SphereSolid{{4, 0, 0}, 2}), solid(SphereSolid{{9, 0, 0}, 2})};
    CHECK(repeated_volume(touching, 4000).volume == 0);
}

TEST_CASE("a calculated volume fits within the doubt of the points and its own error") {
    const Solid block = box({0, 0, 0}, {10, 10, 10});
    const std::array<Solid, 1> ball = {solid(SphereSolid{{10, 5, 5}, 2})};
    const double half = 2.0 / 3 * std::numbers::pi * 8;
    const auto sampled = [&](int points) { return covered_volume(block, ball, points); };
    CHECK(fits(half, 0.1, sampled));
    CHECK(fits(half - 0.1, 0.1, sampled));
    CHECK_FALSE(fits(0, 0.1, sampled));
    CHECK_FALSE(fits(0.9 * half, 0.1, sampled));
    CHECK_FALSE(fits(2 * half, 0.1, sampled));
    CHECK_FALSE(fits(std::nan(""), 0.1, sampled));
    CHECK_FALSE(fits(0, 100, sampled));  // overlooked, in a body so large that its volume says nothing
    CHECK(fits(0.5, 100, sampled));
}

TEST_CASE("the space between walls, and all that is made of it, cannot be sampled") {
    const Solid block = box({0, 0, 0}, {10, 10, 10});
    const Solid air = solid(EnclosedSolid{{5, 5, 5}, {block}});
    CHECK(can_be_sampled(block));
    CHECK(can_be_sampled(solid(RepeatedSolid{without(block, solid(SphereSolid{{0, 0, 0}, 2})), 3, {5, 0, 0}})));
    CHECK_FALSE(can_be_sampled(air));
    CHECK_FALSE(can_be_sampled(solid(TranslatedSolid{without(block, air), {1, 0, 0}})));
}
