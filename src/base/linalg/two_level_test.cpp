// TwoLevel against Cholesky, on lattices of springs that are stiff in some directions and soft in others.
#include "base/linalg/two_level.hpp"

#include <doctest/doctest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "base/linalg/cholesky.hpp"

using namespace pliant::linalg;

namespace {

struct Problem {
    SymmetricPattern pattern;
    std::vector<double> values;
    std::vector<double> positions;  ///< (nodes, 3)
    Eigen::VectorXd force;

    [[nodiscard]] std::span<double> whole(Eigen::VectorXd& v) const {
        return {v.data(), static_cast<std::size_t>(v.size())};
    }
};

/// A beam of unit cells with springs along edges and both diagonals of each face, thirty times stiffer in its second
/// half, on a soft foundation at one end; rotated by `turn`.
Problem beam(int along, int across, const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity()) {
    Problem p;
    const int side = across + 1, nodes = (along + 1) * side * side;
    const auto node = [&](int i, int j, int k) { return (i * side + j) * side + k; };
    struct DirectedSpring {
        int a, b;
        double stiffness;
    };
    std::vector<DirectedSpring> springs;
    std::vector<std::vector<int>> cliques;
    std::vector<Eigen::Vector3d> at(static_cast<std::size_t>(nodes));
    const auto join = [&](int a, int b, int i) {
        springs.push_back({a, b, 2 * i < along ? 1.0 : 30.0});
        cliques.push_back({a, b});
    };
    for (int i = 0; i <= along; ++i) {
        for (int j = 0; j < side; ++j) {
            for (int k = 0; k < side; ++k) {
                at[static_cast<std::size_t>(node(i, j, k))] = turn * Eigen::Vector3d(i, j, k);
                for (const auto& [di, dj, dk] : {std::array{1, 0, 0},
                                                 {0, 1, 0},
                                                 {0, 0, 1},
                                                 {1, 1, 0},
                                                 {1, -1, 0},
                                                 {1, 0, 1},
                                                 {1, 0, -1},
                                                 {0, 1, 1},
                                                 {0, 1, -1}}) {
                    const int l = i + di, m = j + dj, n = k + dk;
                    if (l <= along && m >= 0 && m < side && n >= 0 && n < side) join(node(i, j, k), node(l, m, n), i);
                }
            }
        }
    }
    p.pattern = make_pattern(nodes, 3, cliques);
    p.values.assign(p.pattern.entries(), 0.0);
    for (const DirectedSpring& s : springs) {
        const Eigen::Vector3d d = (at[static_cast<std::size_t>(s.b)] - at[static_cast<std::size_t>(s.a)]).normalized();
        const Eigen::Matrix3d K = s.stiffness * d * d.transpose();
        p.pattern.add_block(p.values, s.a, s.a, K);
        p.pattern.add_block(p.values, s.b, s.b, K);
        p.pattern.add_block(p.values, std::max(s.a, s.b), std::min(s.a, s.b), -K);
    }
    for (int n = 0; n < side * side; ++n) p.pattern.add_block(p.values, n, n, Eigen::Matrix3d::Identity());
    for (const Eigen::Vector3d& x : at) p.positions.insert(p.positions.end(), x.data(), x.data() + 3);
    p.force = Eigen::VectorXd::Zero(3 * nodes);
    for (int i = 0; i < 3 * nodes; ++i) p.force[i] = std::sin(12.9898 * i) + (i / 3 >= nodes - side * side ? 1 : 0);
    return p;
}

Eigen::VectorXd factored(const Problem& p) {
    Cholesky factor(p.pattern);
    REQUIRE(factor.factorise(p.values));
    Eigen::VectorXd x = p.force;
    factor.solve(p.whole(x), 1);
    return x;
}

/// Error of x in the norm of the matrix, relative to `exact`.
double error(const Problem& p, const Eigen::VectorXd& x, const Eigen::VectorXd& exact) {
    const auto energy = [&](Eigen::VectorXd v) {
        Eigen::VectorXd product = Eigen::VectorXd::Zero(v.size());
        add_product(p.pattern, p.values, p.whole(v), 1, p.whole(product));
        return v.dot(product);
    };
    return std::sqrt(energy(x - exact) / energy(exact));
}

using Outcome = TwoLevel::Outcome;
constexpr int limit = 100;

}  // namespace

TEST_CASE("a slender beam is solved as by Cholesky, in few iterations at any size") {
    for (const int along : {12, 48, 96}) {
        const Problem p = beam(along, 4);
        TwoLevel levels(p.pattern);
        REQUIRE(levels.set(p.values, p.positions));
        Eigen::VectorXd x = p.force;
        REQUIRE(levels.solve(p.whole(x), 1, 1e-4, limit) == Outcome::solved);
        const Eigen::VectorXd exact = factored(p);
        CHECK(error(p, x, exact) < 3e-4);
        CHECK(levels.iterations() <= 40);
    }
}

TEST_CASE("a rotated body reuses its coarse level, a different one gets a new one") {
    const Problem before = beam(48, 4);
    TwoLevel levels(before.pattern);
    REQUIRE(levels.set(before.values, before.positions));
    Eigen::VectorXd x = before.force;
    REQUIRE(levels.solve(before.whole(x), 1, 1e-4, limit) == Outcome::solved);
    const int usual = levels.iterations();
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(2, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
    Problem after = beam(48, 4, turn);
    REQUIRE(levels.set(after.values, after.positions));
    x = after.force;
    REQUIRE(levels.solve(after.whole(x), 1, 1e-4, limit) == Outcome::solved);
    CHECK(levels.iterations() <= usual + 5);
    const Eigen::VectorXd exact = factored(after);
    CHECK(error(after, x, exact) < 3e-4);

    // Soft and stiff parts swapped: far from the previous state.
    std::vector<double> scaled = after.values;
    for (std::size_t k = 0; k < scaled.size(); ++k) scaled[k] *= 1e4;
    for (int n = 0; n < 25; ++n) after.pattern.add_block(scaled, n, n, -0.9999 * 1e4 * Eigen::Matrix3d::Identity());
    after.values = scaled;
    REQUIRE(levels.set(after.values, after.positions));
    x = after.force;
    REQUIRE(levels.solve(after.whole(x), 1, 1e-4, limit) == Outcome::solved);
    const Eigen::VectorXd other = factored(after);
    CHECK(error(after, x, other) < 3e-4);
    // The old coarse level is soon replaced.
    TwoLevel fresh(after.pattern);
    REQUIRE(fresh.set(after.values, after.positions));
    Eigen::VectorXd y = after.force;
    REQUIRE(fresh.solve(after.whole(y), 1, 1e-4, limit) == Outcome::solved);
    CHECK(levels.iterations() <= fresh.iterations() + 12);
}

TEST_CASE("what was solved before matters no further than the matrix of the coarse level") {
    const Problem base = beam(48, 4);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
    const Problem other = beam(48, 4, turn * turn), last = beam(48, 4, turn);
    const auto solve = [&](TwoLevel& levels, const Problem& p, Reuse reuse) {
        levels.take(p.values, p.positions);
        REQUIRE(levels.prepare(reuse));
        Eigen::VectorXd x = p.force;
        REQUIRE(levels.solve(p.whole(x), 1, 1e-4, limit) == Outcome::solved);
        return x;
    };
    TwoLevel levels(base.pattern);
    const Eigen::VectorXd first = solve(levels, base, Reuse::turned);
    CHECK_FALSE(levels.is_turned());
    (void)solve(levels, other, Reuse::turned);
    const Eigen::VectorXd turned = solve(levels, last, Reuse::turned);
    CHECK(levels.is_turned());
    const double gain = levels.usual_gain();
    CHECK(solve(levels, base, Reuse::kept) == first);
    CHECK_FALSE(levels.is_turned());
    CHECK(solve(levels, last, Reuse::turned) == turned);

    TwoLevel again(base.pattern);
    (void)solve(again, other, Reuse::turned);
    again.take(base.values, base.positions);
    REQUIRE(again.prepare(Reuse::none));
    again.set_usual_gain(gain);
    CHECK(solve(again, last, Reuse::turned) == turned);
}

TEST_CASE("an indefinite matrix is found on setting it or while solving") {
    for (const double shift : {-0.05, -3.0, -1e3}) {
        Problem p = beam(24, 3);
        for (int n = 0; n < p.pattern.nodes; ++n)
            p.pattern.add_block(p.values, n, n, Eigen::Matrix3d(shift * Eigen::Matrix3d::Identity()));
        Cholesky factor(p.pattern);
        REQUIRE_FALSE(factor.factorise(p.values));
        TwoLevel levels(p.pattern);
        if (!levels.set(p.values, p.positions)) continue;
        Eigen::VectorXd x = p.force;
        CHECK(levels.solve(p.whole(x), 1, 1e-4, limit) == Outcome::indefinite);
    }
}

TEST_CASE("bodies of very few nodes, isolated ones included") {
    for (const auto& [nodes, cliques] :
         {std::pair{1, std::vector<std::vector<int>>{}}, {2, {{0, 1}}}, {5, {{0, 1}, {1, 2}}}}) {
        Problem p;
        p.pattern = make_pattern(nodes, 3, cliques);
        p.values.assign(p.pattern.entries(), 0.0);
        for (int n = 0; n < nodes; ++n) {
            p.pattern.add_block(p.values, n, n, Eigen::Matrix3d(Eigen::Vector3d(2, 3, 4).asDiagonal()));
            p.positions.insert(p.positions.end(), {static_cast<double>(n), 0, 0});
        }
        for (const auto& c : cliques)
            p.pattern.add_block(p.values, c[1], c[0], Eigen::Matrix3d(-0.5 * Eigen::Matrix3d::Identity()));
        p.force = Eigen::VectorXd::LinSpaced(3 * nodes, 1, 2);
        TwoLevel levels(p.pattern);
        REQUIRE(levels.set(p.values, p.positions));
        Eigen::VectorXd x = p.force;
        REQUIRE(levels.solve(p.whole(x), 1, 1e-5, limit) == Outcome::solved);
        CHECK(error(p, x, factored(p)) < 3e-5);
    }
}

TEST_CASE("several right-hand sides of any size, zero included; after a time-out the best solution is kept") {
    const Problem p = beam(24, 3);
    TwoLevel levels(p.pattern);
    REQUIRE(levels.set(p.values, p.positions));
    Eigen::MatrixXd x(p.force.size(), 3);
    x.col(0) = 1e-30 * p.force;
    x.col(1).setZero();
    x.col(2) = 1e30 * p.force;
    const Eigen::VectorXd exact = factored(p);
    REQUIRE(levels.solve({x.data(), static_cast<std::size_t>(x.size())}, 3, 1e-4, limit) == Outcome::solved);
    CHECK(error(p, 1e30 * x.col(0), exact) < 3e-4);
    CHECK(x.col(1).norm() == 0);
    CHECK(error(p, 1e-30 * x.col(2), exact) < 3e-4);
    Eigen::VectorXd hurried = p.force;
    CHECK(levels.solve(p.whole(hurried), 1, 1e-6, 3) == Outcome::slow);
    CHECK(hurried.dot(p.force) > 0);
    CHECK(error(p, hurried, exact) < 1);
}

namespace {

/// Two constraints on the beam, with normals of very different size.
struct Constrained {
    explicit Constrained(const Problem& p) : normals(p.force.size(), 2), wanted(0.3e-6, -2e6) {
        normals.col(0) = 1e-6 * Eigen::VectorXd::LinSpaced(p.force.size(), -1, 2).array().cos();
        normals.col(1).setZero();
        normals(p.force.size() - 1, 1) = 1e6;
        normals(p.force.size() - 4, 1) = -2e6;
    }
    [[nodiscard]] TwoLevel::Constraints view() const {
        return {{normals.data(), static_cast<std::size_t>(normals.size())}, {wanted.data(), 2}};
    }
    Eigen::MatrixXd normals;
    Eigen::Vector2d wanted;
};

}  // namespace

TEST_CASE("with constraints, the motion and the multipliers are those of block elimination") {
    const Problem p = beam(24, 3);
    const Constrained c(p);
    Cholesky factor(p.pattern);
    REQUIRE(factor.factorise(p.values));
    Eigen::MatrixXd columns(p.force.size(), 3);
    columns << p.force, c.normals;
    factor.solve({columns.data(), static_cast<std::size_t>(columns.size())}, 3);
    const Eigen::Matrix2d S = c.normals.transpose() * columns.rightCols(2);
    const Eigen::Vector2d y = S.inverse() * (c.normals.transpose() * columns.col(0) - c.wanted);
    const Eigen::VectorXd exact = columns.col(0) - columns.rightCols(2) * y;

    TwoLevel levels(p.pattern);
    REQUIRE(levels.set(p.values, p.positions));
    Eigen::VectorXd x = p.force;
    Eigen::Vector2d multipliers;
    REQUIRE(levels.solve_constrained(p.whole(x), c.view(), {multipliers.data(), 2}, 1e-4, limit) == Outcome::solved);
    CHECK(error(p, x, exact) < 3e-4);
    for (const Eigen::Index k : {0, 1}) {
        CHECK(std::fabs(c.normals.col(k).dot(x) - c.wanted[k]) < 1e-12 * c.normals.col(k).norm() * x.norm());
        CHECK(std::fabs(multipliers[k] - y[k]) < 1e-3 * std::fabs(y[k]));
    }
}

TEST_CASE("constraints that depend on each other, or say nothing, are refused, and nothing is changed") {
    const Problem p = beam(12, 2);
    TwoLevel levels(p.pattern);
    REQUIRE(levels.set(p.values, p.positions));
    Constrained c(p);
    Eigen::Vector2d multipliers(7, 7);
    for (const double factor : {-3.0, 0.0}) {
        c.normals.col(1) = factor * c.normals.col(0);
        Eigen::VectorXd x = p.force;
        CHECK(levels.solve_constrained(p.whole(x), c.view(), {multipliers.data(), 2}, 1e-4, limit) == Outcome::slow);
        CHECK(x == p.force);
        CHECK(multipliers == Eigen::Vector2d(7, 7));
    }
}

TEST_CASE("the same bits on any number of threads") {
    const Problem p = beam(64, 6);
    const Constrained c(p);
    Eigen::VectorXd first, first_held;
    for (const std::size_t threads : {1, 2, 4}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        TwoLevel levels(p.pattern);
        REQUIRE(levels.set(p.values, p.positions));
        Eigen::VectorXd x = p.force;
        REQUIRE(levels.solve(p.whole(x), 1, 1e-4, limit) == Outcome::solved);
        Eigen::VectorXd held = p.force;
        Eigen::Vector2d multipliers;
        REQUIRE(levels.solve_constrained(p.whole(held), c.view(), {multipliers.data(), 2}, 1e-4, limit) ==
                Outcome::solved);
        if (threads == 1) first = x, first_held = held;
        CHECK(x == first);
        CHECK(held == first_held);
    }
}
