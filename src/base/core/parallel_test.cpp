#include "base/core/parallel.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <vector>

using namespace pliant;

TEST_CASE("every item is visited once") {
    std::vector<std::atomic<int>> visits(1003);
    parallel_for(visits.size(), 10, [&](std::size_t begin, std::size_t end) {
        CHECK(end - begin <= 10);
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    for (const auto& count : visits) CHECK(count == 1);
    parallel_for(0, 10, [](std::size_t, std::size_t) { FAIL("nothing to do"); });
}

TEST_CASE("a parallel sum gives the same bits every time") {
    const auto piece = [](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i) sum += 1.0 / static_cast<double>(i + 1);
        return sum;
    };
    const double first = parallel_sum(100000, 64, piece);
    for (int i = 0; i < 20; ++i) CHECK(parallel_sum(100000, 64, piece) == first);
}
