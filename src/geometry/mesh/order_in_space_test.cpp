#include "geometry/mesh/order_in_space.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <tuple>

using namespace pliant;
using namespace pliant::mesh;

TEST_CASE("items close in space are close in the order, whatever their initial order") {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> in_box(0, 1);
    for (const std::size_t count : {0U, 1U, 64U, 65U, 30000U}) {
        std::vector<Vec3> place(count);
        for (Vec3& p : place) p = {3 * in_box(random), in_box(random), in_box(random)};
        std::vector<int> items(count), shuffled;
        std::iota(items.begin(), items.end(), 0);
        shuffled = items;
        std::shuffle(shuffled.begin(), shuffled.end(), random);
        const double layer = std::cbrt(3 * 6 / static_cast<double>(count));
        order_in_space(items, place, layer);
        order_in_space(shuffled, place, layer);
        CHECK(items == shuffled);
        std::sort(shuffled.begin(), shuffled.end());
        for (std::size_t k = 0; k < count; ++k) REQUIRE(shuffled[k] == static_cast<int>(k));
        if (count < 1000) continue;
        double apart = 0;
        for (std::size_t k = 1; k < count; ++k) apart += norm(place[items[k]] - place[items[k - 1]]);
        CHECK(apart / static_cast<double>(count) < 1.5 * layer);  // in random order they would be 1.3 apart, 15 layers
    }
}

TEST_CASE("the nodes of a grid are numbered row by row") {
    std::vector<Vec3> place;
    for (int k = 0; k < 3; ++k) {
        for (int j = 0; j < 40; ++j) {
            for (int i = 0; i < 7; ++i) place.push_back({0.5 * i, 0.5 * j, 0.5 * k});
        }
    }
    std::vector<int> items(place.size());
    std::iota(items.begin(), items.end(), 0);
    order_in_space(items, place, 0.45);
    for (std::size_t n = 1; n < items.size(); ++n) {
        const Vec3 a = place[items[n - 1]], b = place[items[n]];
        CHECK(std::tuple(a.y, a.x, a.z) < std::tuple(b.y, b.x, b.z));
    }
}

TEST_CASE("coincident items, and extreme layer thicknesses, keep the order of numbers") {
    const double none = std::numeric_limits<double>::quiet_NaN(), all = std::numeric_limits<double>::infinity();
    for (const double layer : {0.0, 1.0, none, all}) {
        std::vector<Vec3> place(500, Vec3{1, 2, 3});
        if (layer == all) place[7] = {-1e308, 1e308, 0};
        std::vector<int> items(place.size());
        std::iota(items.rbegin(), items.rend(), 0);
        order_in_space(items, place, layer);
        CHECK(std::is_sorted(items.begin(), items.end()));
    }
}
