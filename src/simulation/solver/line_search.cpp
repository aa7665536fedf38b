#include "simulation/solver/line_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pliant::sim {
namespace {

constexpr double violation_share = 0.01;
constexpr double smallest_J_left = 0.05;  // of the smallest det F, after one step
constexpr std::size_t error_memory = 10;
constexpr double close = 0.05;  // an error

}  // namespace

bool constraints_hold(const Evaluation& evaluation, double tolerance) {
    return evaluation.violation <= violation_share * tolerance;
}

bool is_converged(const Evaluation& evaluation, double tolerance) {
    return evaluation.residual <= tolerance && constraints_hold(evaluation, tolerance);
}

LineSearch::LineSearch(const SolvedActuators& solved, std::size_t actuators, const Forces& forces)
    : solved_(solved), forces_(forces), penalty_weights_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(actuators))) {}

std::optional<LineSearch::Found> LineSearch::search(const State& from, const Evaluation& now,
                                                    const Direction& direction, const Path& path,
                                                    const std::function<Evaluation(const State&)>& evaluate) {
    raise_penalty_weights(direction.multiplier);
    const double cost = constraint_penalty(now);  // a full step removes it
    const double start = now.energy_J + cost;
    const double slope = direction.slope_J - cost;
    for (double alpha = path.longest; alpha > path.shortest; alpha *= 0.5) {
        State next = from;
        next.x = path.at(alpha);
        next.multiplier += alpha * (direction.multiplier - from.multiplier);
        Evaluation evaluation = evaluate(next);
        obstacle_ = evaluation.flaw;
        if (!evaluation.possible() || !(evaluation.min_J > smallest_J_left * now.min_J)) continue;
        // An accelerated step may lower the merit although it is not a descent direction; then rounding is not
        // tolerated.
        const double rounding = slope < 0 ? forces_.energy_rounding_J : 0;
        const double merit = evaluation.energy_J + constraint_penalty(evaluation);
        const bool lower = forces_.conservative && merit < start - 1e-4 * alpha * std::fabs(slope) + rounding;
        const bool nearer = forces_.conservative ? evaluation.error() < 0.5 * now.error()
                                                 : evaluation.error() < (1 - 1e-3 * alpha) * allowed_error(now.error());
        if (!lower && !nearer) continue;
        errors_.push_back(evaluation.error());
        if (errors_.size() > error_memory) errors_.pop_front();
        next.multiplier = evaluation.multiplier;
        return Found{std::move(next), std::move(evaluation), alpha};
    }
    return std::nullopt;
}

/// The penalty weight must exceed every multiplier of the constraint, or the merit would prefer long cables.
void LineSearch::raise_penalty_weights(const Eigen::VectorXd& multiplier) {
    for (const SolvedActuators::Constraint& one : solved_.all()) {
        if (!one.drives_measure) continue;
        double& weight = penalty_weights_[one.actuator];
        weight = std::max(weight, 2 * std::fabs(multiplier[one.actuator]) * one.rest_measure);
    }
}

/// Penalty term of the merit for the current constraint violation: zero for a cable that is not too long.
double LineSearch::constraint_penalty(const Evaluation& evaluation) const {
    double cost = 0;
    for (const SolvedActuators::Constraint& one : solved_.all()) {
        const double violation = evaluation.constraint_violation[one.actuator];
        cost += penalty_weights_[one.actuator] * (one.only_pulls ? std::max(violation, 0.0) : std::fabs(violation));
    }
    return cost;
}

/// Without an energy only the error can guide. It is a ratio of forces and increases when a cable begins to pull, so it
/// may increase for a while: not above the largest of the last steps, nor initially above that of any loaded body (the
/// non-monotone search of Grippo, Lampariello and Lucidi 1986). Close to equilibrium, and with tangents that include
/// the skew part, an increase means that the step leads to another equilibrium: none is allowed.
double LineSearch::allowed_error(double error_now) const {
    if (forces_.skew_in_tangent && error_now < close) return error_now;
    return errors_.size() < error_memory ? 2 : *std::max_element(errors_.begin(), errors_.end());
}

}  // namespace pliant::sim
