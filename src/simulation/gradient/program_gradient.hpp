// Gradient of the outcome of a program with respect to everything that it depends on, for quasi-static programs and
// motions in time.
#pragma once

#include <vector>

#include "base/core/progress.hpp"
#include "simulation/gradient/objective.hpp"
#include "simulation/gradient/variation.hpp"
#include "simulation/model/model.hpp"
#include "simulation/parts/robot_names.hpp"

namespace pliant::sim {

struct ProgramGradient {
    double value = 0;                         ///< of the objective
    std::vector<std::vector<double>> values;  ///< (steps, measures)
    /// With respect to everything except the inputs, which have values of their own at each instant. Gas that is
    /// prescribed as a ratio follows the ambient pressure.
    Variation by;
    /// An equilibrium that was solved for: the end of each step and, if a step was halved, the states in between, which
    /// only matter with friction or inertia.
    struct Instant {
        int step = 0;
        double time = 0;
        Eigen::VectorXd by_inputs;  ///< (inputs(at)); empty: not requested, or nothing depends on them
    };
    std::vector<Instant> instants;  ///< in chronological order
    /// (6, objects) with respect to the initial velocity, m/s, and angular velocity, rad/s, of each; empty: not a
    /// motion in time.
    Eigen::MatrixXd by_start;
    int steps_taken = 0;  ///< total number of solved steps, including those recomputed
};

struct GradientOptions {
    By by{};
    /// Number of states kept if steps depend on earlier ones: with 8, each of 220 steps is solved at most four times,
    /// each of 715 at most five times. Memory does not grow with the number of steps.
    int kept = 8;
};

/// Runs a program as run() does, without its checks, and differentiates it backwards with the adjoint of each step. A
/// quasi-static step depends on its own inputs alone, except for contact friction, whose slip starts from the end of
/// the previous step; a step in time depends on positions and velocities of the last one or two steps. Lagged
/// quantities are held fixed: the normal forces and tangents of friction, and the tension shares of cables with
/// friction. Errors: a measure of something that does not exist; a step that does not converge, or that has no
/// derivative (see Linearisation::adjoint); cancelled.
[[nodiscard]] Result<ProgramGradient> program_gradient(const Model& model, const Program& program,
                                                       const Objective& objective, const GradientOptions& options,
                                                       Progress& progress);

}  // namespace pliant::sim
