// Record of one solver iteration.
#pragma once

#include "simulation/parts/robot_names.hpp"

namespace pliant::sim {

/// One iteration of a solver: the state at its end.
struct IterationRecord {
    int step = 0;                       ///< of the program
    double time = 0;                    ///< program time that is being solved for
    Solver solver = Solver::automatic;  ///< the current one: never `automatic`
    int iteration = 0;                  ///< 0: the initial state; a new 0 starts a new attempt
    double residual = 0;                ///< as in Step
    double violation = 0;  ///< largest constraint violation: of a prescribed length or volume, relative to rest
    double energy_J = 0;   ///< elastic and of prescribed tensions, pressures and gas, minus the work of loads
    double alpha = 0;      ///< accepted step length; 0 for the initial state
    double min_J = 1;      ///< smallest det F
};

}  // namespace pliant::sim
