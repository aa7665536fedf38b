// The complete state of a robot at one instant, as a value.
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

/// A state and its position along the path: a time or any other measure of progress.
struct Moment {
    double along = 0;
    State state;
};

/// A previous moment. The state is shared by all copies.
struct PastMoment {
    double along = 0;
    std::shared_ptr<const State> state;
};

/// May be copied, kept and continued: a step from a copy gives the same bits as one from the original, whatever was
/// solved in between. Belongs to one model. Materials have no internal variables: their forces follow from the
/// positions.
struct RobotState {
    Moment now;                    ///< positions and multipliers
    Inputs inputs;                 ///< as requested: `controls` may hold weighted lengths instead
    std::optional<Inputs> before;  ///< inputs of the last previous state, if a step by inputs started from it
    std::vector<Drive> drives;     ///< (actuators) those of `inputs`, and of actuators that are not steered
    /// The controls of its equilibrium, with contact and friction as found.
    Controls controls;
    Evaluation evaluation;  ///< of all this; derived from it
    /// Previous states, the latest last: used to predict the next one.
    std::deque<PastMoment> past;
    History history;                             ///< positions and velocities, for a motion in time
    std::shared_ptr<const SolverMemory> memory;  ///< null: the solver starts anew

    [[nodiscard]] const Eigen::VectorXd& x() const { return now.state.x; }
};

}  // namespace pliant::sim
