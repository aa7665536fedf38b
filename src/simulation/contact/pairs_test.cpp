#include "simulation/contact/pairs.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <string>

#include "base/core/near.hpp"
#include "simulation/contact/barrier.hpp"
#include "simulation/contact/test_derivatives.hpp"

using namespace pliant;
using namespace pliant::sim::contact;

namespace {

struct PairCase {
    std::string name;
    Pair pair;
    Stencil x;
};

Pair pair_of(PairKind kind, double reach) {
    Pair pair;
    pair.kind = kind;
    pair.reach_m = reach;
    pair.area_m2 = 0.3;
    pair.parallel_m4 = 1e-3;
    pair.normal = {0, 0.6, 0.8};
    if (kind == PairKind::sphere_triangle) pair.radius_m = 0.5;
    return pair;
}

/// Every way in which two features can be near, with distances from 0.1 to 0.5.
std::vector<PairCase> cases() {
    const Pair pt = pair_of(PairKind::point_triangle, 0.7), ee = pair_of(PairKind::edge_edge, 0.7),
               ball = pair_of(PairKind::sphere_triangle, 0.7);
    return {
        {"point and face", pt, {{{0.25, 0.25, 0.3}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}},
        {"point and edge", pt, {{{0.5, -0.3, 0.4}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}},
        {"point and corner", pt, {{{-0.1, -0.2, 0.1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}},
        {"edges", ee, {{{-1, 0, 0}, {1, 0, 0}, {0, -0.5, 0.3}, {0, 1, 0.3}}}},
        {"end and edge", ee, {{{0.3, 0, 0.4}, {1, 0, 2}, {0, -1, 0}, {0, 1, 0}}}},
        {"ends", ee, {{{0.1, 0, 0}, {2, 0, 0.5}, {0, 0, 0}, {-1, 1, 0}}}},
        {"nearly parallel edges that cross", ee, {{{-1, 0, 0}, {1, 0, 0}, {-0.5, -0.003, 0.3}, {0.6, 0.004, 0.3}}}},
        {"nearly parallel edges, end first", ee, {{{-1, 0, 0}, {1, 0, 0}, {0.5, 0.003, 0.2}, {1.6, 0.008, 0.21}}}},
        {"point over a plane",
         pair_of(PairKind::point_plane, 0.7),
         {{{0.3, 0.1, 0.4}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}}},
        {"sphere and face", ball, {{{0.25, 0.25, 0.8}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}},
        {"sphere and edge", ball, {{{0.5, -0.5, 0.6}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}},
        {"sphere and corner", ball, {{{-0.4, -0.4, 0.4}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}},
    };
}

constexpr double stiffness = 50;

Stencil scaled_about_origin(Stencil x, double s) {
    for (Vec3& p : x) p *= s;
    return x;
}

}  // namespace

TEST_CASE("gradient and Hessian of every kind of pair agree with finite differences") {
    std::mt19937 random(5);
    for (const PairCase& c : cases()) {
        CAPTURE(c.name);
        for (int turn = 0; turn < 5; ++turn) {
            const Motion motion = random_motion(random);
            const Stencil x = motion(c.x);
            Pair pair = c.pair;
            pair.normal = motion.turned(pair.normal);
            const auto f = [&](const Stencil& y) { return potential(pair, stiffness, y); };
            const auto df = [&](const Stencil& y) { return potential_gradient(pair, stiffness, y); };
            REQUIRE(f(x) > 0);
            CHECK((df(x) - numeric_gradient(f, x, 1e-6)).norm() < 1e-6 * df(x).norm());
            const Matrix12 H = potential_hessian(pair, stiffness, x);
            CHECK((H - H.transpose()).norm() < 1e-10 * H.norm());
            CHECK((H - numeric_hessian(df, x, 1e-7)).norm() < 1e-5 * H.norm());
        }
    }
}

TEST_CASE("the mollifier acts in the nearly parallel cases only") {
    for (const PairCase& c : cases()) {
        CAPTURE(c.name);
        if (c.pair.kind != PairKind::edge_edge) continue;
        const bool parallel = c.name.starts_with("nearly");
        CHECK((mollifier(squared_cross(c.x), c.pair.parallel_m4).value < 1) == parallel);
    }
}

TEST_CASE("the forces of a pair sum to zero, have no moment, and rotate with the pair") {
    std::mt19937 random(6);
    for (const PairCase& c : cases()) {
        CAPTURE(c.name);
        const Vector12 g = potential_gradient(c.pair, stiffness, c.x);
        Vec3 force, moment;
        for (std::size_t i = 0; i < 4; ++i) {
            const Vec3 f{g[3 * i], g[3 * i + 1], g[3 * i + 2]};
            force += f;
            moment += cross(c.x[i], f);
        }
        CHECK(norm(force) < 1e-12 * g.norm());
        // A half-space cannot turn, so a point beside its node has a moment about it.
        if (c.pair.kind != PairKind::point_plane) CHECK(norm(moment) < 1e-11 * g.norm());

        const Motion motion = random_motion(random);
        Pair turned = c.pair;
        turned.normal = motion.turned(turned.normal);
        const Vector12 h = potential_gradient(turned, stiffness, motion(c.x));
        CHECK(potential(turned, stiffness, motion(c.x)) ==
              near(potential(c.pair, stiffness, c.x), {.relative = 1e-12}));
        for (int i = 0; i < 4; ++i) {
            const Vec3 f = motion.turned({g[3 * i], g[3 * i + 1], g[3 * i + 2]});
            CHECK(norm(f - Vec3{h[3 * i], h[3 * i + 1], h[3 * i + 2]}) < 1e-9 * g.norm());
        }
    }
}

TEST_CASE("at half its reach a plane presses with 4.33 times the stiffness, whatever the reach") {
    for (const double reach : {1e-5, 1e-3, 0.4}) {
        Pair pair = pair_of(PairKind::point_plane, reach);
        const Stencil x{0.5 * reach * pair.normal, {}, {}, {}};
        // −db/dz at z = 1/4: 2 (3/4) ln 4 + (9/16) 4 = 4.3294, and dD/dd = 2 d = d̂.
        CHECK(normal_force(pair, stiffness, x) / (stiffness * pair.area_m2) == near(4.3294, {.relative = 1e-4}));
        CHECK(potential_gradient(pair, stiffness, x).head<3>().norm() ==
              near(normal_force(pair, stiffness, x), {.relative = 1e-5}));
    }
}

TEST_CASE("beyond the reach the energy is zero; at or behind a plane, and in a sphere, it is infinite") {
    for (const PairCase& c : cases()) {
        CAPTURE(c.name);
        const Stencil far = scaled_about_origin(c.x, 8);
        CHECK(potential(c.pair, stiffness, far) == 0);
        CHECK(potential_gradient(c.pair, stiffness, far).norm() == 0);
        CHECK(potential_hessian(c.pair, stiffness, far).norm() == 0);
    }
    const Pair ball = pair_of(PairKind::sphere_triangle, 0.1);
    const Stencil reached{{{0.2, 0.2, 0.3}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    CHECK(std::isinf(potential(ball, stiffness, reached)));
    CHECK(distance(ball, reached) == near(-0.2, {.relative = 1e-12}));
    const Pair plane = pair_of(PairKind::point_plane, 0.1);
    CHECK(std::isinf(potential(plane, stiffness, {Vec3{0, -1, -1}, {}, {}, {}})));
    CHECK(distance(plane, {Vec3{0, -0.6, -0.8}, {}, {}, {}}) == near(-1, {.relative = 1e-12}));
}

TEST_CASE("projection sets negative eigenvalues to zero and keeps the others") {
    for (const PairCase& c : cases()) {
        CAPTURE(c.name);
        const Matrix12 H = potential_hessian(c.pair, stiffness, c.x);
        const Matrix12 P = project_to_positive(H, c.pair.node_count());
        using Solver = Eigen::SelfAdjointEigenSolver<Matrix12>;
        const auto before = Solver(H).eigenvalues().cwiseMax(0).eval(), after = Solver(P).eigenvalues().eval();
        CHECK((before - after).norm() < 1e-10 * H.norm());
        CHECK(Solver(P - H).eigenvalues().minCoeff() > -1e-10 * H.norm());
    }
}
