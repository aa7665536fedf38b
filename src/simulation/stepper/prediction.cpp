#include "simulation/stepper/prediction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "simulation/solver/prescribed_approach.hpp"

namespace pliant::sim {
namespace {

// Largest error of an initial state. Beyond it the body buckles or a new contact begins: then the last state is better,
// because at least its tangent is sound.
constexpr double worst_start = 0.2;
constexpr double good_start = 0.03;

// The state k back: 0 is the last one.
const PastMoment& past(const RobotState& robot, std::size_t k) {
    return robot.past[robot.past.size() - k];
}
double along_of(const RobotState& robot, std::size_t k) {
    return k == 0 ? robot.now.along : past(robot, k).along;
}

/// Lagrange polynomials for the last `count` states, the latest first: they sum to 1.
std::vector<double> shares_at(double along, const RobotState& robot, std::size_t count) {
    std::vector<double> shares(count, 1.0);
    for (std::size_t k = 0; k < count; ++k) {
        const double own = along_of(robot, k);
        for (std::size_t other = 0; other < count; ++other) {
            const double there = along_of(robot, other);
            if (other != k) shares[k] *= (along - there) / (own - there);
        }
    }
    return shares;
}

/// Extrapolates the polynomial through the last `count` states, at least 2: multipliers directly, and for each tet its
/// rotation and stretch. A bent body thus keeps its length, whereas straight motion of its nodes would stretch it.
State onward(const Equilibrium& system, const FactoredLaplacian& laplacian, const RobotState& robot, double along,
             std::size_t count, const Controls& controls) {
    const std::vector<double> shares = shares_at(along, robot, count);
    State next{robot.x(), shares[0] * robot.now.state.multiplier};
    system.place_supports(controls, next.x);
    RotatingStep rotating{.now = robot.x().data(), .end = next.x.data()};
    double beyond = 0;  // sum of the shares of all states before the rotation in question
    for (std::size_t k = count - 1; k > 0; --k) {
        const State& before = *past(robot, k).state;
        next.multiplier += shares[k] * before.multiplier;
        beyond += shares[k];
        rotating.past[k - 1] = before.x.data();
        rotating.weights[k - 1] = -beyond;
    }
    next.x = laplacian.rotate(system, rotating);
    for (std::size_t c = 0; c < system.cable_count(); ++c) {
        double& tension = next.multiplier[static_cast<Eigen::Index>(c)];
        if (system.actuators()[c].only_pulls()) tension = std::max(tension, 0.0);
    }
    return next;
}

/// Extrapolates the last four states or, if that ends far from equilibrium, fewer, whichever is nearest; empty if none
/// is near enough.
std::optional<Prediction> extrapolate(const Equilibrium& system, const FactoredLaplacian& laplacian,
                                      const RobotState& robot, double along, const Controls& controls) {
    std::optional<Prediction> best;
    double least = worst_start;
    for (std::size_t count = robot.past.size() + 1; count >= 2 && least > good_start; --count) {
        State state = onward(system, laplacian, robot, along, count, controls);
        // This check comes first: contact then knows whether anything is near at the end.
        if (!passes(system, robot, state, controls)) continue;
        Evaluation e = system.evaluate(state, controls);
        if (!e.possible() || !(e.error() < least)) continue;
        least = e.error();
        best = Prediction{std::move(state), std::move(e), {}};
    }
    return best;
}

}  // namespace

Prediction predict(const Equilibrium& system, const FactoredLaplacian& laplacian, const RobotState& from,
                   const Controls& wanted, std::optional<double> along, const Progress& progress) {
    if (along) {
        if (auto there = extrapolate(system, laplacian, from, *along, wanted)) return *std::move(there);
    }
    Prediction p{follow_supports(system, laplacian, from.now.state, wanted), {}, {}};
    p.evaluation = system.evaluate(p.state, wanted);
    const bool possible = p.evaluation.possible();
    if (possible && passes(system, from, p.state, wanted)) return p;
    const std::string flaw(name(p.evaluation.flaw));
    p.state = from.now.state;
    if (system.model().contact(wanted.met) != nullptr &&
        approach(system, laplacian, from.controls, wanted, p.state, progress)) {
        p.evaluation = system.evaluate(p.state, wanted);
        if (p.evaluation.possible()) return p;
    }
    p.reason = possible ? "the prescribed motion passes through something within one step"
                        : fmt::format("the prescribed motion {}", flaw);
    return p;
}

std::optional<Prediction> start_from(const Equilibrium& system, const RobotState& from, const State& expected,
                                     const Controls& wanted) {
    Prediction p{expected, {}, {}};
    system.place_supports(wanted, p.state.x);
    if (!passes(system, from, p.state, wanted)) return std::nullopt;
    p.evaluation = system.evaluate(p.state, wanted);
    if (!p.evaluation.possible() || !(p.evaluation.error() < worst_start)) return std::nullopt;
    return p;
}

State follow_supports(const Equilibrium& system, const FactoredLaplacian& laplacian, const State& from,
                      const Controls& controls) {
    State next = from;
    system.place_supports(controls, next.x);
    const Eigen::VectorXd motion = next.x - from.x;
    if (motion.squaredNorm() > 0) system.add_free(laplacian.follow(system, motion), 1, next.x);
    return next;
}

bool passes(const Equilibrium& system, const RobotState& from, const State& next, const Controls& controls) {
    return system.is_free(from.x(), next.x - from.x(), from.controls, controls.obstacles - from.controls.obstacles);
}

}  // namespace pliant::sim
