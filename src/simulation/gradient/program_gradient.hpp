// How the outcome of a program of steps changes with everything that it depends on, at rest at each instant or in
// motion through time.
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
    /// By everything but the inputs, which have values of their own at each instant.
    Variation by;
    /// Where an equilibrium was found: the end of each step, and where a step was halved what lies between, which only
    /// counts where there is friction or inertia.
    struct Instant {
        int step = 0;
        double time = 0;
        Eigen::VectorXd by_inputs;  ///< (inputs(at)); empty: not wanted, or nothing depends on them
    };
    std::vector<Instant> instants;  ///< in the order of time
    /// (6, objects) by the velocity, m/s, and the angular velocity, rad/s, with which each starts; empty: not in time.
    Eigen::MatrixXd by_start;
    int steps_taken = 0;  ///< solved in all, those again that were not kept
};

struct GradientOptions {
    By by{};
    /// States that are kept on the way, where steps depend on those before: with 8 of them each of 220 steps is solved
    /// at most four times, each of 715 at most five times. Memory does not grow with the number of steps.
    int kept = 8;
};

/// Runs a program as run() does, but for its checks, and goes back over it with the adjoint of each step. A step at
/// rest depends on its own inputs alone, but for friction of contact, which slips from where the step before has ended;
/// a step in time depends on positions and velocities of the one or two before. What is lagged stays: the normal forces
/// and tangents of friction, the tension shares of cables with friction, the stiffness that damping takes. Errors: a
/// measure of something that is not there; a step that does not converge, or that has no derivative (see
/// Linearisation::adjoint); cancelled.
[[nodiscard]] Result<ProgramGradient> program_gradient(const Model& model, const Program& program,
                                                       const Objective& objective, const GradientOptions& options,
                                                       Progress& progress);

}  // namespace pliant::sim
