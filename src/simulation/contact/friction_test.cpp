#include "simulation/contact/friction.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "base/core/near.hpp"
#include "simulation/contact/test_derivatives.hpp"

using namespace pliant;
using namespace pliant::sim::contact;

namespace {

using Vector = Eigen::VectorXd;

/// A point over a triangle and two crossing edges, eight nodes.
struct Scene {
    std::vector<double> start;
    std::vector<FrozenPair> pairs;
    double slip_m = 0.01;

    [[nodiscard]] Friction friction() const { return {pairs, start, slip_m}; }
};

Scene scene() {
    const Stencil pt{{{0.25, 0.3, 0.3}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    const Stencil ee{{{-1, 0, 5}, {1, 0.2, 5}, {0.1, -0.5, 5.4}, {0, 1, 5.3}}};
    Pair first, second;
    first.nodes = {0, 1, 2, 3};
    second.kind = PairKind::edge_edge;
    second.nodes = {4, 5, 6, 7};
    second.parallel_m4 = 1e-3;
    first.reach_m = second.reach_m = 0.7;
    first.area_m2 = second.area_m2 = 0.2;
    Scene s;
    for (const Stencil& x : {pt, ee})
        for (const Vec3& p : x) s.start.insert(s.start.end(), {p.x, p.y, p.z});
    s.pairs = {freeze(first, 0.4, 100, pt), freeze(second, 0.7, 100, ee)};
    return s;
}

std::vector<double> moved(const Scene& s, double size, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-size, size);
    std::vector<double> x = s.start;
    for (double& c : x) c += uniform(random);
    return x;
}

Vector gradient(const Friction& friction, const std::vector<double>& x) {
    Vector g = Vector::Zero(static_cast<Eigen::Index>(x.size()));
    friction.add_gradient(x, {g.data(), x.size()});
    return g;
}

Eigen::MatrixXd hessian(const Friction& friction, const std::vector<double>& x) {
    const auto n = static_cast<Eigen::Index>(x.size());
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
    friction.visit_hessian(x, [&](int i, int j, const linalg::Matrix3& b) { H.block<3, 3>(3 * i, 3 * j) += b; });
    return H;
}

}  // namespace

TEST_CASE("friction's derivatives agree with finite differences, sticking and sliding") {
    const Scene s = scene();
    const Friction friction = s.friction();
    for (const double size : {0.002, 0.005, 0.1}) {
        CAPTURE(size);
        const std::vector<double> x = moved(s, size, 3);
        const Vector g = gradient(friction, x);
        const Eigen::MatrixXd H = hessian(friction, x);
        for (std::size_t k = 0; k < x.size(); ++k) {
            auto forth = x, back = x;
            const double h = 1e-7;
            forth[k] += h;
            back[k] -= h;
            CHECK(g[k] == near((friction.energy(forth) - friction.energy(back)) / (2 * h), {.relative = 1e-6}));
            const Vector column = (gradient(friction, forth) - gradient(friction, back)) / (2 * h);
            CHECK((H.col(k) - column).norm() < 1e-5 * H.norm());
        }
        CHECK(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(H).eigenvalues().minCoeff() > -1e-10 * H.norm());
    }
}

TEST_CASE("without slip there is no friction force; at full slip it is the coefficient times the normal force") {
    const Scene s = scene();
    const Friction friction = s.friction();
    CHECK(gradient(friction, s.start).norm() == 0);
    std::vector<double> x = s.start;
    x[0] += 0.05;
    x[1] -= 0.02;
    const Vec3 force = friction.force(0, x);
    CHECK(norm(force) == near(s.pairs[0].limit_N, {.relative = 1e-12}));
    CHECK(force.x < 0);
    CHECK(force.y > 0);
    CHECK(std::abs(force.z) < 1e-12);
    CHECK(force.x / force.y == near(-2.5, {.relative = 1e-12}));
    x[0] = s.start[0] + 0.004;
    x[1] = s.start[1];
    CHECK(norm(friction.force(0, x)) == near(s.pairs[0].limit_N * (2 * 0.4 - 0.4 * 0.4), {.relative = 1e-12}));
}

TEST_CASE("motion along the normal causes no friction") {
    const Scene s = scene();
    std::vector<double> x = s.start;
    x[2] += 0.1;
    CHECK(gradient(s.friction(), x).norm() < 1e-15);
}
