#include "simulation/contact/distance.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "base/core/near.hpp"
#include "simulation/contact/test_derivatives.hpp"

using namespace pliant;
using namespace pliant::sim::contact;

namespace {

struct DistanceCase {
    std::string name;
    Stencil x;
    int free;
    double distance;  ///< worked out by hand
};

const std::vector<DistanceCase> point_triangle_cases = {
    {"above the face", {{{0.25, 0.25, 0.3}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, 2, 0.3},
    {"below the face", {{{0.5, 0.25, -0.2}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, 2, 0.2},
    {"first edge", {{{0.5, -0.3, 0.4}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, 1, 0.5},
    {"second edge", {{{1, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, 1, std::sqrt(0.5)},
    {"third edge", {{{-0.4, 0.5, 0.3}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, 1, 0.5},
    {"first corner", {{{-2, -1, 2}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, 0, 3},
    {"second corner", {{{2, -0.5, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, 0, std::sqrt(1.25)},
    {"third corner", {{{-0.5, 2, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, 0, std::sqrt(1.25)},
    {"obtuse triangle, first edge", {{{0.5, -0.1, 0.1}, {0, 0, 0}, {1, 0, 0}, {-1, 0.3, 0}}}, 1, std::sqrt(0.02)},
};

const std::vector<DistanceCase> edge_cases = {
    {"crossing", {{{-1, 0, 0}, {1, 0, 0}, {0, -0.5, 0.3}, {0, 1, 0.3}}}, 2, 0.3},
    {"crossing aslant", {{{-1, 0, 0}, {1, 0, 0}, {-0.4, -0.5, -0.2}, {0.4, 0.5, -0.2}}}, 2, 0.2},
    {"first end, second edge", {{{0.3, 0, 0.4}, {1, 0, 2}, {0, -1, 0}, {0, 1, 0}}}, 1, 0.5},
    {"second end, second edge", {{{1, 0, 2}, {0.3, 0, 0.4}, {0, -1, 0}, {0, 1, 0}}}, 1, 0.5},
    {"first edge, first end", {{{0, -1, 0}, {0, 1, 0}, {0.3, 0, 0.4}, {1, 0, 2}}}, 1, 0.5},
    {"first edge, second end", {{{0, -1, 0}, {0, 1, 0}, {1, 0, 2}, {0.3, 0, 0.4}}}, 1, 0.5},
    {"ends 0 0", {{{1, 0, 0}, {2, 0, 0.5}, {0, 0, 0}, {-1, 1, 0}}}, 0, 1},
    {"ends 0 1", {{{1, 0, 0}, {2, 0, 0.5}, {-1, 1, 0}, {0, 0, 0}}}, 0, 1},
    {"ends 1 0", {{{2, 0, 0.5}, {1, 0, 0}, {0, 0, 0}, {-1, 1, 0}}}, 0, 1},
    {"ends 1 1", {{{2, 0, 0.5}, {1, 0, 0}, {-1, 1, 0}, {0, 0, 0}}}, 0, 1},
};

using Find = Nearest (*)(const Stencil&);

void check_cases(const std::vector<DistanceCase>& cases, Find find) {
    std::mt19937 random(7);
    for (const DistanceCase& c : cases) {
        CAPTURE(c.name);
        for (int turn = 0; turn < 5; ++turn) {
            const Motion motion = turn == 0 ? Motion{{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {}} : random_motion(random);
            const Stencil x = motion(c.x);
            const Nearest n = find(x);
            CHECK(n.free == c.free);
            CHECK(std::sqrt(squared_distance(n, x)) == near(c.distance, {.relative = 1e-12}));
            const auto D = [&](const Stencil& y) { return squared_distance(find(y), y); };
            const auto dD = [&](const Stencil& y) { return squared_distance_gradient(find(y), y); };
            CHECK((dD(x) - numeric_gradient(D, x, 1e-6)).norm() < 1e-8);
            const Matrix12 H = squared_distance_hessian(n, x);
            CHECK((H - H.transpose()).norm() < 1e-12 * H.norm());
            CHECK((H - numeric_hessian(dD, x, 1e-6)).norm() < 1e-7 * H.norm());
        }
    }
}

/// The smallest distance over a fine grid of points on the two features.
double sampled_point_triangle(const Stencil& x) {
    double best = HUGE_VAL;
    constexpr int n = 200;
    for (int i = 0; i <= n; ++i)
        for (int j = 0; i + j <= n; ++j) {
            const double s = double(i) / n, t = double(j) / n;
            best = std::fmin(best, norm(x[0] - ((1 - s - t) * x[1] + s * x[2] + t * x[3])));
        }
    return best;
}

double sampled_edges(const Stencil& x) {
    double best = HUGE_VAL;
    constexpr int n = 200;
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) {
            const double s = double(i) / n, t = double(j) / n;
            best = std::fmin(best, norm((1 - s) * x[0] + s * x[1] - ((1 - t) * x[2] + t * x[3])));
        }
    return best;
}

}  // namespace

TEST_CASE("point and triangle: distance and derivatives for every nearest feature") {
    check_cases(point_triangle_cases, nearest_point_triangle);
}

TEST_CASE("two edges: distance and derivatives for every nearest feature") {
    check_cases(edge_cases, nearest_edges);
}

TEST_CASE("no sampled point of the features is nearer, and the nearest sample is almost as near") {
    std::mt19937 random(11);
    for (int k = 0; k < 60; ++k) {
        const Stencil x{random_vector(random), random_vector(random), random_vector(random), random_vector(random)};
        const double pt = std::sqrt(squared_distance(nearest_point_triangle(x), x)), pt_net = sampled_point_triangle(x);
        CHECK(pt <= pt_net + 1e-14);
        CHECK(pt > pt_net - 0.02);
        const double ee = std::sqrt(squared_distance(nearest_edges(x), x)), ee_net = sampled_edges(x);
        CHECK(ee <= ee_net + 1e-14);
        CHECK(ee > ee_net - 0.02);
        CHECK(distance_bound(Features::point_triangle, x) <= pt + 1e-14);
        CHECK(distance_bound(Features::edge_edge, x) <= ee + 1e-14);
    }
}

TEST_CASE("the quick bound equals the distance where features face each other") {
    const Stencil pt{{{0, 0, 1}, {-1, -1, 0}, {1, -1, 0}, {0, 2, 0}}},
        ee{{{-1, 0, 0}, {1, 0, 0}, {0, -2, 3}, {0, 2, 3}}};
    CHECK(distance_bound(Features::point_triangle, pt) == near(1, {.relative = 1e-12}));
    CHECK(distance_bound(Features::edge_edge, ee) == near(3, {.relative = 1e-12}));
}

TEST_CASE("nearly parallel edges that cross have their true distance") {
    for (const double angle : {1e-2, 1e-4, 1e-6, 1e-7}) {
        const double gap = 1e-5;
        const Stencil x{{{-1, 0, 0}, {1, 0, 0}, {-1, -angle, gap}, {1, angle, gap}}};
        CHECK(std::sqrt(squared_distance(nearest_edges(x), x)) == near(gap, {.relative = 1e-12}));
    }
    const Stencil parallel{{{-1, 0, 0}, {1, 0, 0}, {-0.5, 0, 0.25}, {3, 0, 0.25}}};
    CHECK(squared_distance(nearest_edges(parallel), parallel) == near(0.0625, {.relative = 1e-12}));
}

TEST_CASE("degenerate features: a triangle without area, an edge without length") {
    const Stencil line{{{0.5, 1, 0}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}}};
    CHECK(squared_distance(nearest_point_triangle(line), line) == near(1, {.relative = 1e-12}));
    const Stencil point{{{0, 0, 1}, {0, 0, 1}, {-1, 0, 0}, {1, 0, 0}}};
    CHECK(squared_distance(nearest_edges(point), point) == near(1, {.relative = 1e-12}));
}

TEST_CASE("the derivatives of the squared cross product of two edges agree with finite differences") {
    std::mt19937 random(13);
    for (int k = 0; k < 20; ++k) {
        const Stencil x{random_vector(random), random_vector(random), random_vector(random), random_vector(random)};
        CHECK((squared_cross_gradient(x) - numeric_gradient(squared_cross, x, 1e-5)).norm() < 1e-7);
        CHECK((squared_cross_hessian(x) - numeric_hessian(squared_cross_gradient, x, 1e-5)).norm() < 1e-7);
    }
    const Stencil square{{{0, 0, 0}, {2, 0, 0}, {0, 0, 1}, {0, 3, 1}}};
    CHECK(squared_cross(square) == near(36, {.relative = 1e-12}));
}
