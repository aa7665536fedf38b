// The program of a robot: how many steps, by which solver, quasi-static or in time.
#pragma once

#include <optional>

#include "robot/description/solver.hpp"

namespace pliant::robot {

/// Rayleigh damping: C = mass * M + stiffness * K, K the stiffness to changes of strain (theory.md).
struct Damping {
    double mass_per_s = 0;
    double stiffness_s = 0;
};

/// Time integration scheme.
enum class Integrator {
    bdf2,               ///< slightly dissipates unresolved motion, and never adds energy
    energy_conserving,  ///< conserves the energy of undamped motion without contact
};

/// Motion in time instead of quasi-static steps.
struct Dynamics {
    Damping damping;
    Integrator integrator = Integrator::bdf2;
    double time_tolerance_m = 0;  ///< above 0: adapts the step length so that the error of each step stays below this
    double time_step_s = 0;       ///< as the file says; steps of the program divide its duration. 0: as these
};

struct Program {
    int steps = 30;
    double duration = 1;  ///< end time; steps have equal length
    double tolerance = 1e-4;
    Solver solver = Solver::automatic;
    std::optional<Dynamics> dynamics = std::nullopt;
    int iteration_limit = 0;  ///< per solved step; 0: the default of the solver
    /// How to leave an unstable equilibrium: the state is disturbed by this largest motion of a node and settles at the
    /// stable one that the energy then decreases to. 0: only a warning.
    double imperfection_m = 0;
    /// Checks results for instability and intersecting surfaces, which takes as long as a few steps. Off only for
    /// timing the solver.
    bool checks = true;
};

}  // namespace pliant::robot
