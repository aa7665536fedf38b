// Which vat holds which resin of a job, and from which layer on where one vat does not hold enough.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/plan.hpp"

namespace pliant::plan {

struct Assignment {
    std::vector<VatUse> vats;
    std::vector<int> vat_of_material;            ///< the first one; -1 for a material without images
    std::vector<std::vector<int>> vat_of_image;  ///< for each layer, in the order of its images
    std::vector<RefillBefore> refills;           ///< by layer
    std::vector<std::string> warnings;
};

/// Whether some vat holds the resin of each of these materials; the error names the resin and the one that was meant.
[[nodiscard]] Status check_resins(const std::vector<job::Material>& materials, const machine::Printer& printer);

/// See make_plan. Materials of the same resin share a vat; where the printer holds a resin in several vats, the next
/// one takes over on the layer that the one before cannot fill.
[[nodiscard]] Result<Assignment> assign_vats(const job::Manifest& job, const machine::Printer& printer);

}  // namespace pliant::plan
