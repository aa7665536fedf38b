// What a piece of a step is asked for: shared by the files of the stepper.
#pragma once

#include "simulation/stepper/stepper.hpp"

namespace pliant::sim {

inline constexpr double piece_rounding = 1e-7;      ///< of the shortest piece
inline constexpr double smallest_piece = 1.0 / 64;  ///< of a step by inputs

/// One piece of a path.
struct Stepper::Target {
    double along;
    Controls controls;
    bool onward;
    const State* expected;      ///< there; null: unknown
    double* error_m = nullptr;  ///< receives the error in time if requested; the step is rejected if it is above the
                                ///< next
    double largest_error_m = 0;
    int iteration_limit = 0;  ///< 0: that of the options
};

/// Appends an attempt's iterations to those of the step; `along`: where the attempt was to end.
void note(const std::vector<IterationRecord>& history, double along, StepReport& report);

}  // namespace pliant::sim
