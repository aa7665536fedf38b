// Which vat holds which resin of a job.
#pragma once

#include <string>
#include <vector>

#include "core/error.hpp"
#include "job/job.hpp"
#include "machine/printer.hpp"
#include "plan/plan.hpp"

namespace pliant::plan {

struct Assignment {
    std::vector<VatUse> vats;          ///< without resin_ml
    std::vector<int> vat_of_material;  ///< -1 for a material without images
    std::vector<std::string> warnings;
};

/// See make_plan. Materials of the same resin share a vat.
[[nodiscard]] Result<Assignment> assign_vats(const job::Manifest& job, const machine::Printer& printer);

}  // namespace pliant::plan
