#include "simulation/contact/ccd.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"
#include "simulation/contact/test_derivatives.hpp"

using namespace pliant;
using namespace pliant::sim::contact;

namespace {

Stencil at(const Stencil& x, const Stencil& dx, double t) {
    return {x[0] + t * dx[0], x[1] + t * dx[1], x[2] + t * dx[2], x[3] + t * dx[3]};
}

double distance(Features features, const Stencil& x) {
    return std::sqrt(squared_distance(nearest(features, x), x));
}

}  // namespace

TEST_CASE("a point that falls on a triangle stops at the distance share it must keep") {
    const Stencil x{{{0.2, 0.2, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, dx{{{0, 0, -2}, {}, {}, {}}};
    CHECK(largest_step(Features::point_triangle, x, dx, 0.1, 1) == near(0.45, {.relative = 2e-3}));
    CHECK(largest_step(Features::point_triangle, x, dx, 0.1, 0.3) == 0.3);
    const Stencil away{{{0, 0, 5}, {}, {}, {}}};
    CHECK(largest_step(Features::point_triangle, x, away, 0.1, 1) == 1);
    const Stencil touching{{{0.2, 0.2, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    CHECK(largest_step(Features::point_triangle, touching, dx, 0.1, 1) == 0);
}

TEST_CASE("a sphere stops at the distance of its surface") {
    const Stencil x{{{0.2, 0.2, 1.5}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, dx{{{0, 0, -2}, {}, {}, {}}};
    CHECK(largest_step(Features::point_triangle, x, dx, 0.1, 1, 0.5) == near(0.45, {.relative = 2e-3}));
    const Stencil aside{{{3, 0, -2}, {}, {}, {}}};  // passes the corner at (1, 0, 0)
    CHECK(largest_step(Features::point_triangle, x, aside, 0.1, 1, 0.2) == 1);
    CHECK(largest_step(Features::point_triangle, x, aside, 0.1, 1, 1.2) < 0.3);
    CHECK(largest_step(Features::point_triangle, x, dx, 0.1, 1, 1.5) == 0);
}

TEST_CASE("a common motion of both features, however large, does not limit the step") {
    const Stencil x{{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0.1}, {0, 1, 0.1}}};
    const Vec3 far{10, -20, 30};
    CHECK(largest_step(Features::edge_edge, x, {far, far, far, far}, 0.1, 1) == 1);
}

TEST_CASE("random motions: the share is kept at every instant of the step, and the step is not too short") {
    std::mt19937 random(3);
    int hindered = 0;
    for (int k = 0; k < 4000; ++k) {
        const Features features = k % 2 == 0 ? Features::point_triangle : Features::edge_edge;
        const Stencil x{random_vector(random), random_vector(random), random_vector(random), random_vector(random)};
        const Stencil dx{2 * random_vector(random), 2 * random_vector(random), 2 * random_vector(random),
                         2 * random_vector(random)};
        const double step = largest_step(features, x, dx, 0.1, 1), start = distance(features, x);
        for (int s = 0; s <= 200; ++s)
            REQUIRE(distance(features, at(x, dx, step * s / 200)) >= 0.1 * start * (1 - 1e-9));
        if (step == 1) continue;
        ++hindered;
        CHECK(distance(features, at(x, dx, step)) <= 0.102 * start);
    }
    CHECK(hindered > 400);
}
