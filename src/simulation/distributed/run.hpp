// Runs a program on many ranks: sim::run (simulation/run) for a robot that is spread over them.
#pragma once

#include <functional>
#include <optional>

#include "base/core/error.hpp"
#include "simulation/distributed/balance.hpp"
#include "simulation/distributed/linear_solver.hpp"
#include "simulation/run/trajectory.hpp"
#include "simulation/stepper/robot_state.hpp"

namespace pliant::sim::distributed {

/// A run between two steps: whatever it needs to go on. States are over the nodes that this rank knows.
struct RunState {
    int step = 0;  ///< the last that was done; 0: none
    Moment now;
    std::vector<Moment> past;  ///< those before it, the latest last: they tell where the next may be
    Trajectory so_far;         ///< the rest state and `step` steps, without positions; the same on all ranks
};

struct RunOptions {
    Preconditioner preconditioner = Preconditioner::gamg;
    /// Called with each step as it comes, the rest state first, and positions of the known nodes (3n); an error ends
    /// the run. May be empty, on all ranks alike: collective.
    std::function<Status(const Step&, const Eigen::VectorXd& x)> on_step{};
    /// Whether the robot meets itself on the straight way between two states of the known nodes: the run stops there.
    /// May be empty, on all ranks alike: collective.
    std::function<bool(const Eigen::VectorXd& from, const Eigen::VectorXd& to)> meets{};
    /// Called after every step; an error ends the run. May be empty, on all ranks alike: collective.
    std::function<Status(const RunState&)> on_checkpoint{};
    std::optional<RunState> begin{};  ///< goes on from here instead of from rest
};

struct RunResult {
    Trajectory trajectory;  ///< without positions, the same on all ranks
    LinearWork work;        ///< of the tangents
    LinearWork turning;     ///< of steps that turn
};

/// A step that does not converge is halved, and halved again, down to 1/64 of a step; a program that cannot finish
/// keeps the steps that converged and says where and why it stopped. Whether an equilibrium is stable is not looked
/// at. Collective. An error is one of a callback.
[[nodiscard]] Result<RunResult> run(const Balance& balance, const Program& program, RunOptions options);

}  // namespace pliant::sim::distributed
