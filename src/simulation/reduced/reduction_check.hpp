// A reduced model beside the whole robot, at inputs that it was not made from.
#pragma once

#include <limits>
#include <vector>

#include "simulation/reduced/reduced_model.hpp"

namespace pliant::sim::reduced {

struct CheckedInputs {
    std::vector<double> values;   ///< (inputs) in the units of the targets
    bool found = false;           ///< both have an equilibrium; otherwise what follows is not known
    bool touching = false;        ///< the whole robot touches itself there, which the reduced model does not know
    double motion_m = 0;          ///< largest motion of a node of the whole robot, from rest
    double error_m = 0;           ///< largest difference of a node
    double estimated_m = 0;       ///< the estimate of that
    double multiplier_error = 0;  ///< largest of tensions and pressures, relative to the largest of the samples
    double reduced_s = 0, estimate_s = 0, whole_s = 0;  ///< times of the solutions, from the inputs before
};

/// At `count` inputs spread over the ranges of `task`. Errors: cancelled.
[[nodiscard]] Result<std::vector<CheckedInputs>> check_reduction(const ReducedModel& model,
                                                                 const StepperOptions& stepping,
                                                                 const InverseTask& task, int count,
                                                                 Progress& progress);

}  // namespace pliant::sim::reduced
