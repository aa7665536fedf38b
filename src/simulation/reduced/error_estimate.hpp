// How far the equilibrium of a reduced model is from that of the whole robot.
//
// The equations of the whole robot are evaluated there and projected on all modes of the samples, many more than the
// model uses. One step of Newton's method with the tangent of some more weighted tets tells how far the robot would
// move to balance what is left. It costs little more than the evaluation, and tells what the modes that are not used
// and the weighted tets do to the result. It cannot see motions that no sample has: outside the ranges, or with other
// loads, only exact() is certain.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "simulation/reduced/reduced_solver.hpp"

namespace pliant::sim::reduced {

/// Length of the longest motion of a node, of all (3n).
[[nodiscard]] double longest(const Eigen::VectorXd& motion);

struct Estimate {
    /// Largest motion of any node to the equilibrium of the whole robot, m; infinite if the state is impossible there.
    double error_m = std::numeric_limits<double>::infinity();
    std::vector<double> marker_errors_m;  ///< (markers)
    Eigen::VectorXd multiplier_errors;    ///< (actuators)
    State corrected;                      ///< of the whole robot, after that step; empty if the state is impossible
};

/// Not thread-safe: it has work space.
class ErrorEstimator {
public:
    /// Both must outlive it; `stepper` is of the whole model.
    ErrorEstimator(const ReducedModel& model, Stepper& stepper);

    [[nodiscard]] Estimate estimate(const ReducedState& state);
    /// The equilibrium of the whole robot at the inputs of the reduced state, searched from `corrected`, or from the
    /// nearest sample. Empty: none is found.
    [[nodiscard]] std::optional<RobotState> exact(const ReducedState& state, const Estimate& estimate,
                                                  const Progress& progress);

private:
    const ReducedModel* model_;
    Stepper* stepper_;
    ProjectedTangent tangent_;
};

}  // namespace pliant::sim::reduced
