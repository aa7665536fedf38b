// What the light of a job will cure below undersides, told before anything is printed.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/plan.hpp"

namespace pliant::app {

/// One line for each resin; none: no deeper than the drawing allows. Cost: every image is read. Errors: an image cannot
/// be read, the mask is missing.
[[nodiscard]] Result<std::vector<std::string>> overcure_warnings(const job::Archive& archive, const plan::Plan& plan,
                                                                 const machine::Printer& printer);

}  // namespace pliant::app
