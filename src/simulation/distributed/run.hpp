// Runs the program of a distributed robot: sim::run (simulation/run) on many ranks.
#pragma once

#include <functional>
#include <optional>

#include "base/core/error.hpp"
#include "simulation/distributed/distributed_equilibrium.hpp"
#include "simulation/distributed/linear_solver.hpp"
#include "simulation/run/trajectory.hpp"
#include "simulation/stepper/robot_state.hpp"

namespace pliant::sim::distributed {

/// A run between two steps: everything it needs to continue. States are over the local nodes.
struct RunState {
    int step = 0;  ///< the last completed one; 0: none
    Moment now;
    std::vector<Moment> past;  ///< earlier states, the latest last: for the prediction of the next
    Trajectory so_far;         ///< the rest state and `step` steps, without positions; the same on all ranks
};

struct RunOptions {
    Preconditioner preconditioner = Preconditioner::gamg;
    /// Called after each step, first for the rest state, with the positions of the local nodes (3n); an error ends the
    /// run. May be empty. Collective.
    std::function<Status(const Step&, const Eigen::VectorXd& x)> on_step{};
    /// True if the robot meets itself on the straight path between two states of the local nodes: the run stops there.
    /// May be empty. Collective.
    std::function<bool(const Eigen::VectorXd& from, const Eigen::VectorXd& to)> meets{};
    /// Called after every step; an error ends the run. May be empty. Collective.
    std::function<Status(const RunState&)> on_checkpoint{};
    std::optional<RunState> begin{};  ///< where to continue; none: from rest
};

struct RunResult {
    Trajectory trajectory;  ///< without positions, the same on all ranks
    LinearWork work;        ///< of the tangents
    LinearWork rotation;    ///< of rotating steps
};

/// A step that does not converge is halved repeatedly, down to 1/64 of a step; a program that cannot finish keeps the
/// steps that converged and says where and why it stopped. The stability of equilibria is not checked. Collective.
/// Errors are those of the callbacks.
[[nodiscard]] Result<RunResult> run(const DistributedEquilibrium& system, const Program& program, RunOptions options);

}  // namespace pliant::sim::distributed
