// Effect of a print on the cleaning solution: consumption, resin content, and before which layers an operator must
// service it.
#pragma once

#include <string>
#include <vector>

#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/machine/solution.hpp"

namespace pliant::plan {

struct Plan;

/// Maintenance needed before a layer.
struct CareBefore {
    int layer = 0;
    machine::SolutionCare care = machine::SolutionCare::change;
};

struct SolutionUse {
    bool goes_round = false;  ///< recirculated through a reservoir; otherwise every cleaning takes fresh solution
    double pumped_ml = 0;     ///< by all cleanings in total
    double used_ml = 0;       ///< consumed: evaporated and discarded or, without a circuit, everything
    double liquid_ml = 0;     ///< in the reservoir at the end
    double resin_share = 0;   ///< fraction of resin in that
    double spent_share = 0;   ///< fraction of resin at which it is changed
    double filter_ml = 0;     ///< resin in the filter at the end
    std::vector<CareBefore> care;
};

/// Fills in Plan::brushed_ml, waste_ml, solvent_ml and `solution`, and warns of a circuit that needs service before the
/// print. Needs `order`, `vats` and `layer_seconds` of the plan; `printer` has the resins that the plan fills in.
void reckon_solution(Plan& plan, const job::Manifest& job, const machine::Printer& printer);

}  // namespace pliant::plan
