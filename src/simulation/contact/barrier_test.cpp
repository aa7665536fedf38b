#include "simulation/contact/barrier.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>

#include "base/core/near.hpp"

using namespace pliant::sim::contact;
using pliant::near;

TEST_CASE("barrier values agree with the formula, and derivatives with finite differences") {
    CHECK(barrier(1.0, 4.0).value == near(0.5625 * std::log(4.0), {.relative = 1e-12}));
    for (const double D : {1e-4, 0.03, 0.5, 1.9}) {
        const double h = 1e-6 * D, reach = 2;
        const Curve low = barrier(D - h, reach), high = barrier(D + h, reach), b = barrier(D, reach);
        CHECK(b.slope == near((high.value - low.value) / (2 * h), {.relative = 1e-7}));
        CHECK(b.curvature == near((high.slope - low.slope) / (2 * h), {.relative = 1e-7}));
        CHECK(b.slope < 0);
    }
}

TEST_CASE("the barrier ends smoothly at its reach, and is infinite at touching") {
    const Curve end = barrier(1 - 1e-6, 1.0);
    CHECK(end.value < 1e-17);
    CHECK(std::abs(end.slope) < 1e-11);
    CHECK(std::abs(end.curvature) < 1e-5);
    CHECK(barrier(1.0, 1.0).value == 0);
    CHECK(barrier(7.0, 1.0).slope == 0);
    CHECK(std::isinf(barrier(0.0, 1.0).value));
}

TEST_CASE("the mollifier rises from 0 to 1 and ends with slope 0") {
    CHECK(mollifier(0, 2).value == 0);
    CHECK(mollifier(1, 2).value == near(0.75, {.relative = 1e-12}));
    CHECK(mollifier(2, 2).value == 1);
    CHECK(mollifier(2 - 1e-9, 2).slope == near(0, {.absolute = 1e-8}));
    CHECK(mollifier(0.5, 2).slope ==
          near((mollifier(0.5001, 2).value - mollifier(0.4999, 2).value) / 2e-4, {.relative = 1e-8}));
    CHECK(mollifier(0.5, 2).curvature == near(-0.5, {.relative = 1e-12}));
}
