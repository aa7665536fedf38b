#include "base/core/boxes.hpp"

#include <doctest/doctest.h>

#include <array>
#include <numeric>
#include <vector>

using namespace pliant;

TEST_CASE("boxes that touch intersect, and share no volume") {
    const Box3 box{{0, 0, 0}, {1, 1, 1}};
    for (std::size_t k = 0; k < 3; ++k) {
        Box3 beside = box;
        beside.low[k] = 1, beside.high[k] = 2;
        CHECK(boxes_meet(box, beside));
        CHECK_FALSE(boxes_overlap(box, beside));
        beside.low[k] = 1.25;
        CHECK_FALSE(boxes_meet(box, beside));
        CHECK_FALSE(boxes_meet(beside, box));
        CHECK(boxes_meet(box, beside, 0.25));
        CHECK(boxes_meet(beside, box, 0.25));
        CHECK_FALSE(boxes_meet(box, beside, 0.2));
        beside.low[k] = 0.75;
        CHECK(boxes_overlap(box, beside));
    }
    CHECK(boxes_overlap(box, {{0.2, 0.2, 0.2}, {0.3, 0.3, 0.3}}));
}

TEST_CASE("the longest axis is the first of equal ones") {
    const auto axis_of = [](double x, double y, double z) {
        return longest_axis(Box3{{1, 2, 3}, {1 + x, 2 + y, 3 + z}});
    };
    CHECK(axis_of(4, 2, 1) == 0);
    CHECK(axis_of(2, 4, 1) == 1);
    CHECK(axis_of(2, 1, 4) == 2);
    CHECK(axis_of(4, 4, 4) == 0);
    CHECK(axis_of(2, 4, 4) == 1);
    CHECK(axis_of(4, 2, 4) == 0);
}

TEST_CASE("halves do not depend on the initial order") {
    std::vector<int> items(101);
    std::iota(items.begin(), items.end(), 0);
    const auto key = [](int item) { return item * 37 % 10; };  // many are equal
    std::vector<int> expected = items;
    std::sort(expected.begin(), expected.end(),
              [&](int a, int b) { return std::pair(key(a), a) < std::pair(key(b), b); });
    expected.resize(40);
    std::sort(expected.begin(), expected.end());
    for (const int turned : {0, 1, 50}) {
        std::vector<int> halved = items;
        std::rotate(halved.begin(), halved.begin() + turned, halved.end());
        halve(halved, 40, key);
        halved.resize(40);
        std::sort(halved.begin(), halved.end());
        CHECK(halved == expected);
    }
}
