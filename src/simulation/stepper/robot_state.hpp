// A robot at one instant: everything that changes, as a value.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "simulation/elements/inertia.hpp"
#include "simulation/solver/equilibrium.hpp"
#include "simulation/solver/solver_memory.hpp"
#include "simulation/stepper/inputs.hpp"

namespace pliant::sim {

/// A state, and where it stands on the way that led to it: a time or any other measure of progress.
struct Moment {
    double along = 0;
    State state;
};

/// One that is over. The state is shared by all copies.
struct PastMoment {
    double along = 0;
    std::shared_ptr<const State> state;
};

/// May be copied, kept, and gone on from: a step from a copy gives the same bits as one from the original, whatever was
/// solved in between. Belongs to one model. Materials have no internal variables: their forces follow from the
/// positions.
struct RobotState {
    Moment now;                    ///< positions and multipliers
    Inputs inputs;                 ///< as they were asked for: `controls` may hold weighted lengths instead
    std::optional<Inputs> before;  ///< of the last state of the past, where a step by inputs led on from it
    std::vector<Drive> drives;     ///< (actuators) as `inputs`, and those that nobody steers
    /// Under which it is in equilibrium, with contact and friction as they were found.
    Controls controls;
    Evaluation evaluation;  ///< of all this; follows from it
    /// The states before, the latest last: where the next one is looked for.
    std::deque<PastMoment> past;
    History history;                             ///< positions and velocities, for a motion in time
    std::shared_ptr<const SolverMemory> memory;  ///< null: the solver begins anew

    [[nodiscard]] const Eigen::VectorXd& x() const { return now.state.x; }
};

}  // namespace pliant::sim
