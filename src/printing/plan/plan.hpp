// The plan of a job: which resin goes into which vat, in which order the vats are used, what that costs in time and
// resin, and the G-code that does it.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/order.hpp"
#include "printing/plan/sequence.hpp"
#include "printing/plan/solution_use.hpp"

namespace pliant::plan {

/// A vat that the job uses.
struct VatUse {
    int vat = 0;                 ///< index into Printer::vats
    int slot = 0;                ///< where it lives in the tower, from 1
    std::string resin;           ///< what it must be filled with
    std::vector<int> materials;  ///< that are printed from it; indices into Manifest::materials
    double resin_ml = 0;
    bool refill = false;  ///< the printer file names another resin, or none, for it
    int first_layer = 0, last_layer = 0;
    double waste_ml = 0;    ///< resin that clings to the part when this vat leaves it, and is washed off
    double brushed_ml = 0;  ///< of it, before that: what the brush wipes back into the vat
};

/// A vat that is empty before a layer.
struct RefillBefore {
    int layer = 0;
    int slot = 0;
    std::string resin;
};

/// One way to order the vats, for comparison: all changes of vat, the first loading and the last storing included.
struct OrderCost {
    OrderRule rule = OrderRule::naive;
    int swaps = 0;
    double change_s = 0;
};

struct Plan {
    std::string job;
    std::string printer;
    int layers = 0;
    int swaps = 0;                     ///< changes of vat; loading the first vat and putting the last one away are none
    int swap_lower_bound = 0;          ///< the least number that any order of the vats would need
    Seconds seconds;                   ///< total = swap + clean + expose + move
    std::vector<VatUse> vats;          ///< in the order of the printer's vats
    std::vector<int> vat_of_material;  ///< index into Printer::vats of the first vat; -1 for one that prints nothing
    std::vector<std::vector<int>> vat_of_image;  ///< for each layer the vat of each of its images
    std::vector<VatList> order;                  ///< for each layer the vats (indices into Printer::vats) in order
    OrderRule rule = OrderRule::least_cost;      ///< by which `order` was made
    std::vector<OrderCost> compared;             ///< naive, thesis, least cost: what each would take
    double least_change_s = 0;                   ///< no order's changes of vat take less
    std::vector<Seconds> layer_seconds;          ///< of each layer, with the changes of vat before and within it
    double waste_ml = 0;                         ///< resin washed off
    double solvent_ml = 0;                       ///< cleaning solution used up
    std::vector<RefillBefore> refills;           ///< by layer
    std::vector<std::string> warnings;
    double brushed_ml = 0;  ///< resin that brushes wipe off the part, back into its vats
    SolutionUse solution;
};

/// Plans `job` for `printer`. Each resin takes the vat that holds it. One that no vat holds is an error, or, where the
/// job says that any vat will do (Manifest::any_vat), takes the next free vat (empty ones first, then those whose resin
/// the job does not need), with a warning. Further errors (input): a job that was made for another projector, is taller
/// than the machine builds, has more resins than there are vats, or whose layers are not in order.
[[nodiscard]] Result<Plan> make_plan(const job::Manifest& job, const machine::Printer& printer,
                                     OrderRule rule = OrderRule::least_cost);

/// The G-code of the plan; a pure function of its arguments, which must be those of make_plan. The axes are homed
/// first; every coordinate is absolute; no command is over 94 characters. The tower must hold every vat at the start,
/// and does again at the end.
[[nodiscard]] std::string write_gcode(const Plan& plan, const job::Manifest& job, const machine::Printer& printer);

/// What the commands of write_gcode() take: Plan::seconds, reckoned the long way.
[[nodiscard]] Seconds program_seconds(const Plan& plan, const job::Manifest& job, const machine::Printer& printer);

/// The printer as it stands once its vats are filled as the plan asks; resins that its file does not know get the
/// exposures of the job.
[[nodiscard]] machine::Printer filled_printer(const Plan& plan, const job::Manifest& job, machine::Printer printer);

/// For programs: an object with at least layers, swaps, swap_lower_bound, orders, seconds {total, swap, clean, expose,
/// move}, layer_seconds, resin_ml (ml by slot), solvent_ml, waste_ml, order (slots by layer), warnings.
[[nodiscard]] std::string plan_json(const Plan& plan);
/// For people: a table.
[[nodiscard]] std::string plan_text(const Plan& plan);
/// For whoever fills the vats: a line for each, "slot 2: semi-flex, 12.3 ml", and what is to be done about it.
[[nodiscard]] std::vector<std::string> vat_lines(const Plan& plan);
/// "1:02:03", rounded to seconds.
[[nodiscard]] std::string clock_text(double seconds);

}  // namespace pliant::plan
