#include "loop/study/sobol.hpp"

#include <doctest/doctest.h>

#include <set>

using namespace pliant::study;

TEST_CASE("the first Sobol points are the published ones") {
    // Bratley and Fox, and every table since: the first eight points of three dimensions.
    const std::vector<double> expected = {0,     0,     0,     0.5,   0.5,   0.5,   0.75,  0.25,
                                          0.25,  0.25,  0.75,  0.75,  0.375, 0.375, 0.625, 0.875,
                                          0.875, 0.125, 0.625, 0.125, 0.875, 0.125, 0.625, 0.375};
    CHECK(sobol_points(8, 3, 0) == expected);
}

TEST_CASE("every dimension has one point in every 2^-10, with and without a shift") {
    for (const std::uint64_t seed : {0, 1, 2}) {
        const auto points = sobol_points(1024, most_sobol_dimensions, seed);
        for (int d = 0; d < most_sobol_dimensions; ++d) {
            std::set<int> met;
            for (int i = 0; i < 1024; ++i) met.insert(static_cast<int>(points[i * most_sobol_dimensions + d] * 1024));
            CHECK(met.size() == 1024);
        }
    }
}

TEST_CASE("the first two dimensions are a (0, 10, 2)-net: one point in every box of area 2^-10") {
    const auto points = sobol_points(1024, 2, 7);
    for (int a = 0; a <= 10; ++a) {
        std::set<std::pair<int, int>> met;
        for (int i = 0; i < 1024; ++i)
            met.emplace(static_cast<int>(points[2 * i] * (1 << a)),
                        static_cast<int>(points[2 * i + 1] * (1 << (10 - a))));
        CHECK(met.size() == 1024);
    }
}

TEST_CASE("different seeds give different points, the same seed the same") {
    CHECK(sobol_points(64, 5, 3) == sobol_points(64, 5, 3));
    CHECK(sobol_points(64, 5, 3) != sobol_points(64, 5, 4));
}

TEST_CASE("a point does not depend on the number of points or dimensions") {
    const auto few = sobol_points(10, 2, 5), many = sobol_points(100, 4, 5);
    for (int i = 0; i < 10; ++i) {
        CHECK(few[2 * i] == many[4 * i]);
        CHECK(few[2 * i + 1] == many[4 * i + 1]);
    }
}
