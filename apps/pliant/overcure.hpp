// Warnings, before printing, about overcure below undersides of a job.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/plan.hpp"

namespace pliant::app {

/// One line per resin; empty if curing is no deeper than the drawing allows. Cost: every image is read. Errors: an
/// image cannot be read, the mask is missing; cancelled.
[[nodiscard]] Result<std::vector<std::string>> overcure_warnings(const job::Archive& archive, const plan::Plan& plan,
                                                                 const machine::Printer& printer, Progress& progress);

}  // namespace pliant::app
