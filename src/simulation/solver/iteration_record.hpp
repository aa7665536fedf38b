// What a solver did in one iteration.
#pragma once

#include "simulation/parts/robot_names.hpp"

namespace pliant::sim {

/// One iteration of a solver, as the state that it led to.
struct IterationRecord {
    int step = 0;                       ///< of the program
    double time = 0;                    ///< of the program, that the solver wants to reach
    Solver solver = Solver::automatic;  ///< the one at work: never `automatic`
    int iteration = 0;                  ///< 0: where it began; a new 0 is a new attempt
    double residual = 0;                ///< as in Step
    double violation = 0;  ///< largest constraint violation: of a prescribed length or volume, relative to rest
    double energy_J = 0;   ///< elastic and of given tensions, pressures and gas, minus the work of loads
    double alpha = 0;      ///< share of the solver's step that was taken; 0 where it began
    double min_J = 1;      ///< smallest det F
};

}  // namespace pliant::sim
