// The search on functions whose least squares are known.
#include "simulation/identify/least_squares.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "base/core/near.hpp"
#include "simulation/identify/at_bounds.hpp"
#include "simulation/identify/confidence.hpp"

using namespace pliant;
using namespace pliant::sim::identify;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

/// Rosenbrock's: least at (1, 1), along a bent valley. Nothing where x[0] > `wall`.
LeastSquaresProblem rosenbrock(VectorXd& best, double wall) {
    LeastSquaresProblem problem;
    problem.residuals = [&best, wall](const VectorXd& x) -> Result<std::optional<VectorXd>> {
        if (x[0] > wall) return std::nullopt;
        VectorXd r(2);
        r << 10 * (x[1] - x[0] * x[0]), 1 - x[0];
        const auto value = [](const VectorXd& at) {
            return std::pow(10 * (at[1] - at[0] * at[0]), 2) + std::pow(1 - at[0], 2);
        };
        if (best.size() == 0 || value(x) < value(best)) best = x;
        return r;
    };
    problem.jacobian = [&best]() -> Result<MatrixXd> {
        MatrixXd J(2, 2);
        J << -20 * best[0], 10, -1, 0;
        return J;
    };
    problem.low = VectorXd::Constant(2, -unbounded);
    problem.high = VectorXd::Constant(2, unbounded);
    return problem;
}

VectorXd vector(double a, double b) {
    return Eigen::Vector2d(a, b);
}

}  // namespace

TEST_CASE("least squares reaches the minimum of a curved valley, around points without a solution") {
    for (const double wall : {unbounded, 1.02}) {
        VectorXd best;
        const auto end = minimise(rosenbrock(best, wall), vector(-1.2, 1));
        REQUIRE(end);
        CHECK(end->converged);
        CHECK(end->u[0] == near(1, {.relative = 1e-8}));
        CHECK(end->u[1] == near(1, {.relative = 1e-8}));
        CHECK(end->trials < 60);
    }
}

TEST_CASE("with one unknown at its bound the other is optimised") {
    VectorXd best;
    LeastSquaresProblem problem = rosenbrock(best, unbounded);
    problem.high = vector(0.5, unbounded);
    const auto end = minimise(problem, vector(-1.2, 1));
    REQUIRE(end);
    CHECK(end->u[0] == near(0.5, {.relative = 1e-14}));
    CHECK(end->u[1] == near(0.25, {.relative = 1e-6}));  // as far as |r|^2 tells
}

TEST_CASE("too few trials are reported; a start without a solution is an error") {
    VectorXd best;
    LeastSquaresProblem problem = rosenbrock(best, unbounded);
    problem.most_trials = 3;
    const auto end = minimise(problem, vector(-1.2, 1));
    REQUIRE(end);
    CHECK_FALSE(end->converged);
    CHECK(end->trials == 3);
    VectorXd other;
    CHECK_FALSE(minimise(rosenbrock(other, -2), vector(-1.2, 1)));
}

TEST_CASE("the intervals of a straight-line fit agree with the formula") {
    // y = a + b x at x = 0, 1, 2, 3, with residuals that are at right angles to both columns.
    MatrixXd J(4, 2);
    J << 1, 0, 1, 1, 1, 2, 1, 3;
    VectorXd r(4);
    r << 0.1, -0.1, -0.1, 0.1;
    const Confidence known = confidence(J, r, {false, false}, 1e-9);
    // s^2 = 0.04 / 2; var b = s^2 / sum (x - mean)^2 = 0.02 / 5; t(2) = 4.30265.
    CHECK(known.half_width[1] == near(4.30265 * std::sqrt(0.02 / 5), {.relative = 1e-5}));
    CHECK(known.half_width[0] == near(4.30265 * std::sqrt(0.02 * (0.25 + 2.25 / 5)), {.relative = 1e-5}));
    CHECK(known.correlation(0, 1) == near(-1.5 / std::sqrt(3.5), {.relative = 1e-12}));
    CHECK(known.mixed.empty());
    // A row that depends on nothing tells nothing.
    MatrixXd more = MatrixXd::Zero(6, 2);
    more.topRows(4) = J;
    VectorXd of_more = VectorXd::Zero(6);
    of_more.head(4) = r;
    CHECK(confidence(more, of_more, {false, false}, 1e-9).half_width[1] ==
          near(known.half_width[1], {.relative = 1e-12}));
    const Confidence held = confidence(J, r, {true, false}, 1e-9);
    CHECK(held.half_width[1] == near(4.30265 * std::sqrt(0.03 / 2 / 14), {.relative = 2e-3}));
    CHECK(std::isnan(held.half_width[0]));
}

TEST_CASE("what a bound hides from one unknown is open to the other") {
    // y = a + b x at x = 0, 1, 2, 3, where the data ask for a = -0.1, b = 0, and a ends at its lower bound, 0.
    MatrixXd J(4, 2);
    J << 1, 0, 1, 1, 1, 2, 1, 3;
    VectorXd noise(4);
    noise << 0.1, -0.1, -0.1, 0.1;
    // With a at 0 the best b is -0.1 * sum x / sum x^2.
    const double b = -0.1 * 6 / 14;
    const VectorXd r = J * Eigen::Vector2d(0.1, b) + noise;
    CHECK(J.col(1).dot(r) == near(0, {.absolute = 1e-15}));
    const double width = 4.30265 * std::sqrt(0.02 * (0.25 + 2.25 / 5));
    const AtBounds open = at_bounds(J, r, {{1, 10}, {}}, 1e-9);
    CHECK(open.reach[0] == near(width - 0.1, {.relative = 1e-5}));
    CHECK(open.reach[1] == 0);
    // A larger a lets b fall by sum x / sum x^2 of it.
    CHECK(open.below[1] == near((width - 0.1) * 6 / 14, {.relative = 1e-5}));
    CHECK(open.above[1] == 0);
    CHECK(open.mixed.empty());
    // Not beyond the other bound; and not at all where the data exclude the range, or nothing is at a bound.
    CHECK(at_bounds(J, r, {{1, 0.05}, {}}, 1e-9).reach[0] == near(0.05, {.relative = 1e-15}));
    const VectorXd far = J * Eigen::Vector2d(10, -10.0 * 6 / 14) + noise;
    CHECK(at_bounds(J, far, {{1, 10}, {}}, 1e-9).reach[0] == 0);
    CHECK(at_bounds(J, far, {{1, 10}, {}}, 1e-9).below[1] == 0);
    CHECK(at_bounds(J, r, {{}, {}}, 1e-9).below.isZero(0));

    // Two columns that nothing tells apart: all of the room is open to the other, and both are named.
    MatrixXd same(4, 2);
    same << 1, 1, 1, 1, 1, 1, 1, 1;
    const AtBounds mixed = at_bounds(same, noise, {{-1, 3}, {}}, 1e-9);
    CHECK(std::isnan(mixed.reach[0]));
    CHECK(mixed.above[1] == near(3, {.relative = 1e-12}));
    REQUIRE(mixed.mixed.size() == 1);
    CHECK(mixed.mixed[0] == std::vector<std::size_t>{0, 1});
}

TEST_CASE("residuals of two groups have a noise of their own") {
    // The mean of eight values, of which four are ten times as noisy.
    const MatrixXd J = MatrixXd::Ones(8, 1);
    VectorXd r(8);
    r << 1, -1, 1, -1, 0.1, -0.1, 0.1, -0.1;
    const Confidence known = confidence(J, r, {false}, 1e-9, {0, 0, 0, 0, 1, 1, 1, 1});
    // Each group has 3.5 values to spare, and half of the weights: variance (s1^2 + s2^2) / 16, s1^2 = 4 / 3.5 =
    // 100 s2^2; freedom 3.5 * 1.01^2 / 1.0001 = 3.57, for which t(3) = 3.18245.
    CHECK(known.half_width[0] == near(3.18245 * std::sqrt(1.01 * 4 / 3.5 / 16), {.relative = 2e-3}));
    CHECK(known.unclear.empty());
    // The noise of a value on its own is not known, unless it hardly counts.
    const Confidence lone = confidence(J, r, {false}, 1e-9, {0, 0, 0, 0, 0, 0, 0, 1});
    CHECK(std::isnan(lone.half_width[0]));
    CHECK(lone.unclear == std::set<int>{1});
    MatrixXd weak = J;
    weak(7, 0) = 1e-3;
    CHECK(std::isfinite(confidence(weak, r, {false}, 1e-9, {0, 0, 0, 0, 0, 0, 0, 1}).half_width[0]));
}

TEST_CASE("parallel and nearly parallel columns are named; a column of zeros is ignored") {
    MatrixXd J(4, 4);
    J << 1, 2, 1, 0, 1, 2, 0, 0, 2, 4, 1, 0, 3, 6, 5, 0;
    const VectorXd r = VectorXd::Constant(4, 0.1);
    const Confidence known = confidence(J, r, {false, false, false, false}, 1e-9);
    REQUIRE(known.mixed.size() == 1);
    CHECK(known.mixed[0] == std::vector<std::size_t>{0, 1});
    CHECK_FALSE(known.matters[3]);
    CHECK(std::isnan(known.half_width[0]));
    J.col(1) += VectorXd::Constant(4, 0.02);
    J(0, 1) += 0.03;
    const Confidence nearly = confidence(J.leftCols(3), r, {false, false, false}, 1e-9);
    REQUIRE(nearly.mixed.size() == 1);
    CHECK(nearly.mixed[0] == std::vector<std::size_t>{0, 1});
    CHECK(std::fabs(nearly.correlation(0, 1)) > 0.99);
}
