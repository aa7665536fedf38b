#include "base/core/own_core.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <thread>

#include "base/core/parallel.hpp"

using namespace pliant;

#ifndef PLIANT_PLAIN_THREADS
TEST_CASE("loops started on their own core stay on their thread") {
    const std::thread::id here = std::this_thread::get_id();
    std::atomic<int> pieces = 0, elsewhere = 0;
    on_own_core([&] {
        parallel_for(1000, 1, [&](std::size_t, std::size_t) {
            ++pieces;
            if (std::this_thread::get_id() != here) ++elsewhere;
        });
    });
    CHECK(pieces == 1000);
    CHECK(elsewhere == 0);
}
#endif

TEST_CASE("there is at least one core") {
    CHECK(core_count() >= 1);
}
