// Assigns vats to the resins of a job and, where one vat does not hold enough, from which layer on each is used.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/departures.hpp"
#include "printing/plan/plan.hpp"

namespace pliant::plan {

struct Assignment {
    std::vector<VatUse> vats;          ///< without what they give, need and waste, which depends on their order
    std::vector<int> vat_of_material;  ///< the first vat used; -1 for a material without images
    std::vector<std::vector<int>> vat_of_image;  ///< for each layer, in the order of its images
    std::vector<RefillBefore> refills;           ///< by layer
    std::vector<std::string> warnings;
};

/// Checks that some vat holds the resin of each material; the error names the resin and the nearest known one.
[[nodiscard]] Status check_resins(const std::vector<job::Material>& materials, const machine::Printer& printer);

/// See make_plan. Materials of the same resin share a vat; if several vats hold a resin, the next one takes over at the
/// layer for which the previous one has too little left. `carried`: what the part carries off counts as used.
[[nodiscard]] Result<Assignment> assign_vats(const job::Manifest& job, const machine::Printer& printer,
                                             const CarriedOff& carried = {});

}  // namespace pliant::plan
