// The whole print as a sequence of commands: homing, the first vat, every layer, the last vat put away.
#pragma once

#include "job/job.hpp"
#include "machine/printer.hpp"
#include "plan/plan.hpp"
#include "plan/sequence.hpp"

namespace pliant::plan {

/// Needs `order`, `vats` and `vat_of_material` of the plan. The printer must outlive the result.
[[nodiscard]] Sequence print_sequence(const Plan& plan, const job::Manifest& job, const machine::Printer& printer);

}  // namespace pliant::plan
