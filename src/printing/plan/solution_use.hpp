// What a print does to the cleaning solution: how much it takes, how much resin is in it, and before which layers a
// person must look after it.
#pragma once

#include <string>
#include <vector>

#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/machine/solution.hpp"

namespace pliant::plan {

struct Plan;

/// Something to be done before a layer.
struct CareBefore {
    int layer = 0;
    machine::SolutionCare care = machine::SolutionCare::change;
};

struct SolutionUse {
    bool goes_round = false;  ///< through a reservoir; otherwise every cleaning takes fresh solution
    double pumped_ml = 0;     ///< by all cleanings together
    double used_ml = 0;       ///< gone: evaporated, thrown away; or all of it
    double liquid_ml = 0;     ///< in the reservoir in the end
    double resin_share = 0;   ///< of that, resin
    double spent_share = 0;   ///< share of resin at which it is changed
    double filter_ml = 0;     ///< resin in the filter in the end
    std::vector<CareBefore> care;
};

/// Fills in Plan::brushed_ml, waste_ml, solvent_ml and `solution`, and warns of a circuit that must be looked after
/// before the print. Needs `order`, `vats` and `layer_seconds` of the plan; `printer` holds the resins that the plan
/// fills in.
void reckon_solution(Plan& plan, const job::Manifest& job, const machine::Printer& printer);

}  // namespace pliant::plan
