#include "loop/study/design.hpp"

#include <doctest/doctest.h>

#include <set>

using namespace pliant::study;

TEST_CASE("a Latin hypercube has one point in each layer of each dimension") {
    constexpr int count = 37, dimensions = 4;
    const auto points = latin_hypercube(count, dimensions, 3);
    REQUIRE(points.size() == count * dimensions);
    for (int d = 0; d < dimensions; ++d) {
        std::set<int> layers;
        for (int i = 0; i < count; ++i) {
            const double u = points[i * dimensions + d];
            CHECK((u >= 0 && u < 1));
            layers.insert(static_cast<int>(u * count));
        }
        CHECK(layers.size() == count);
    }
    CHECK(points == latin_hypercube(count, dimensions, 3));
    CHECK(points != latin_hypercube(count, dimensions, 4));
}

TEST_CASE("Saltelli's plan: row A, row B, and for each dimension A with that number of B") {
    constexpr int count = 8, dimensions = 3, rows = dimensions + 2;
    const auto points = saltelli_points(count, dimensions, 1);
    REQUIRE(points.size() == count * rows * dimensions);
    const auto at = [&](int i, int row, int d) { return points[(i * rows + row) * dimensions + d]; };
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < dimensions; ++k) {
            for (int d = 0; d < dimensions; ++d) CHECK(at(i, 2 + k, d) == at(i, d == k ? 1 : 0, d));
            CHECK(at(i, 0, k) != at(i, 1, k));
        }
    }
}
