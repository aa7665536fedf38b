#include "simulation/solver/line_search.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

using namespace pliant::sim;

namespace {

/// One unknown with the energy (x - 1)^2, and a measure x that one actuator prescribes.
struct Parabola {
    double limit = 10;   ///< the state is impossible beyond
    double wanted = 10;  ///< of the measure
    [[nodiscard]] Evaluation evaluate(const State& state) const {
        Evaluation e;
        const double x = state.x[0];
        e.min_J = 1;
        if (x > limit) {
            e.flaw = Evaluation::Flaw::inverted;
            return e;
        }
        e.energy_J = (x - 1) * (x - 1);
        e.residual = std::fabs(x - 1);
        e.multiplier = state.multiplier;
        e.constraint_violation = Eigen::VectorXd::Constant(1, x - wanted);
        e.violation = std::max(x - wanted, 0.0);
        return e;
    }
};

std::optional<LineSearch::Found> search_from_rest(LineSearch& search, const Parabola& parabola, double dx,
                                                  double multiplier) {
    const State rest{Eigen::VectorXd::Zero(1), Eigen::VectorXd::Zero(1)};
    const Direction direction{Eigen::VectorXd::Constant(1, dx), Eigen::VectorXd::Constant(1, multiplier), -2 * dx};
    const auto at = [&](double alpha) -> Eigen::VectorXd { return alpha * direction.dx; };
    return search.search(rest, parabola.evaluate(rest), direction, {1, 1e-7, at},
                         [&](const State& state) { return parabola.evaluate(state); });
}

SolvedActuators cable() {
    return {{{Drive::Kind::measure, 0}}, {true}, {1.0}};
}

}  // namespace

TEST_CASE("the line search accepts the full step if it lowers the energy") {
    const SolvedActuators none({{Drive::Kind::multiplier, 0}}, {true}, {1.0});
    LineSearch search(none, 1, {});
    const auto found = search_from_rest(search, {}, 1, 0);
    REQUIRE(found);
    CHECK(found->alpha == 1);
    CHECK(found->state.x[0] == 1);
    CHECK(is_converged(found->evaluation, 1e-4));
}

TEST_CASE("the line search halves steps that are impossible or raise the energy") {
    const SolvedActuators none({{Drive::Kind::multiplier, 0}}, {true}, {1.0});
    LineSearch search(none, 1, {});
    const auto possible = search_from_rest(search, {.limit = 0.6}, 1, 0);
    REQUIRE(possible);
    CHECK(possible->alpha == 0.5);
    const auto lower = search_from_rest(search, {}, 5, 0);
    REQUIRE(lower);
    CHECK(lower->alpha == 0.25);
    CHECK(!search_from_rest(search, {}, -1, 0));
    CHECK(search.obstacle() == Evaluation::Flaw::none);
    CHECK(!search_from_rest(search, {.limit = -1}, 1, 0));
    CHECK(search.obstacle() == Evaluation::Flaw::inverted);
}

TEST_CASE("the merit refuses a lower energy that violates a constraint, as soon as its multiplier is known") {
    const SolvedActuators solved = cable();
    LineSearch unaware(solved, 1, {});
    CHECK(search_from_rest(unaware, {.wanted = 0}, 1, 0));
    LineSearch search(solved, 1, {});
    CHECK(!search_from_rest(search, {.wanted = 0}, 1, 3));
}

TEST_CASE("without an energy the error may rise for a while, but not close to equilibrium with a skew tangent") {
    const SolvedActuators none({{Drive::Kind::multiplier, 0}}, {true}, {1.0});
    LineSearch search(none, 1, {.conservative = false});
    CHECK(search_from_rest(search, {}, -0.5, 0));
    CHECK(!search_from_rest(search, {}, -1.5, 0)->state.x.isApprox(Eigen::VectorXd::Constant(1, -1.5)));
    LineSearch strict(none, 1, {.conservative = false, .skew_in_tangent = true});
    const State near{Eigen::VectorXd::Constant(1, 0.97), Eigen::VectorXd::Zero(1)};
    const Parabola parabola;
    const Direction away{Eigen::VectorXd::Constant(1, -0.01), Eigen::VectorXd::Zero(1), 0};
    const auto at = [&](double alpha) -> Eigen::VectorXd { return near.x + alpha * away.dx; };
    CHECK(!strict.search(near, parabola.evaluate(near), away, {1, 1e-7, at},
                         [&](const State& state) { return parabola.evaluate(state); }));
}

TEST_CASE("multipliers of solved actuators") {
    const SolvedActuators solved({{Drive::Kind::multiplier, 3}, {Drive::Kind::measure, 1}, {Drive::Kind::gas, 50}},
                                 {true, true, false}, {1.0, 2.0, 4.0});
    CHECK(solved.actuators() == std::vector<Eigen::Index>{1, 2});
    Eigen::VectorXd multiplier = Eigen::Vector3d(3, 5, -7);
    CHECK(solved.scaled(multiplier) == Eigen::Vector2d(10, -28));
    const std::vector<Drive> drives{{Drive::Kind::multiplier, 3}, {Drive::Kind::measure, 1}, {Drive::Kind::gas, 50}};
    // -dg/dm of g = 50 / (3 - m) at m = -7, over the square of the measure at rest
    CHECK(solved.compliances(drives, multiplier, 3).isApprox(Eigen::Vector2d(0, 50.0 / 100 / 16)));
    solved.add(Eigen::Vector2d(-20, -4), multiplier);
    CHECK(multiplier == Eigen::Vector3d(3, 0, -8));  // the cable is slack, it cannot push
}
