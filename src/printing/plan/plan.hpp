// The plan of a job: resin of each vat, order of the vats, cost in time and resin, and the G-code.
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
    int slot = 0;                ///< its place in the tower, from 1
    std::string resin;           ///< what it must be filled with
    std::vector<int> materials;  ///< printed from it; indices into Manifest::materials
    double resin_ml = 0;         ///< used by the job
    double needed_ml = 0;        ///< in the vat before the print: what is printed and wasted before its first
                                 ///< refill, and what must stay to cover its floor
    bool refill = false;         ///< the printer file names another resin for it, or none
    int first_layer = 0, last_layer = 0;
    double waste_ml = 0;    ///< resin on the part when it has left this vat and its brush, to be washed off
    double brushed_ml = 0;  ///< resin wiped back into the vat by the brush before that
};

/// A vat that runs empty before a layer.
struct RefillBefore {
    int layer = 0;
    int slot = 0;
    std::string resin;
};

/// One way to order the vats, for comparison; includes all vat changes, the first loading and the last storing.
struct OrderCost {
    OrderRule rule = OrderRule::naive;
    int swaps = 0;
    double change_s = 0;   ///< that the changes take
    double penalty_s = 0;  ///< of the pairs, which only count in the choice
};

struct Plan {
    std::string job;
    std::string printer;
    int layers = 0;
    int swaps = 0;                     ///< loading the first vat and storing the last one do not count
    int swap_lower_bound = 0;          ///< least possible number over all orders of the vats
    Seconds seconds;                   ///< total = swap + clean + expose + move
    std::vector<VatUse> vats;          ///< in the order of the printer's vats
    std::vector<int> vat_of_material;  ///< index into Printer::vats of the first vat; -1 for a material that prints
                                       ///< nothing
    std::vector<std::vector<int>> vat_of_image;  ///< for each layer, the vat of each of its images
    std::vector<VatList> order;                  ///< for each layer, the vats (indices into Printer::vats) in order
    OrderRule rule = OrderRule::least_cost;      ///< rule that gave `order`
    std::vector<OrderCost> compared;             ///< naive, thesis, least cost: the time of each
    double least_change_s = 0;                   ///< lower bound of change_s + penalty_s over all orders
    std::vector<Seconds> layer_seconds;          ///< of each layer, including vat changes before and within it
    double waste_ml = 0;                         ///< resin that the part carries off, also what no cleaning removes
    double solvent_ml = 0;                       ///< cleaning solution consumed
    std::vector<RefillBefore> refills;           ///< by layer
    std::vector<std::string> warnings;
    double brushed_ml = 0;  ///< resin that brushes wipe off the part, back into its vats
    SolutionUse solution;

    /// The layers before which the vat in this slot is refilled.
    [[nodiscard]] std::vector<int> refills_of(int slot) const;
};

/// Errors: the top of the last layer is higher than the machine builds.
[[nodiscard]] Status check_height(const std::string& job, int top_um, const std::string& printer, int build_height_um);

/// Plans `job` for `printer`. Each resin uses the vat that holds it. A resin that no vat holds is an error or, if the
/// job allows any vat (Manifest::any_vat), takes the next free one (empty ones first, then those whose resin the job
/// does not need), with a warning. Further errors (input): a job for another projector, taller than the machine builds,
/// with more resins than vats, or with layers out of order.
[[nodiscard]] Result<Plan> make_plan(const job::Manifest& job, const machine::Printer& printer,
                                     OrderRule rule = OrderRule::least_cost);

/// The G-code of the plan; a pure function of its arguments, which must be those of make_plan. The axes are homed
/// first; every coordinate is absolute; no command exceeds 94 characters. The tower must hold every vat at the start,
/// and does so at the end.
[[nodiscard]] std::string write_gcode(const Plan& plan, const job::Manifest& job, const machine::Printer& printer);

/// Duration of the commands of write_gcode(): Plan::seconds, by direct summation.
[[nodiscard]] Seconds program_seconds(const Plan& plan, const job::Manifest& job, const machine::Printer& printer);

/// The printer with its vats filled as the plan requires; resins missing from its file get the job's exposures.
[[nodiscard]] machine::Printer filled_printer(const Plan& plan, const job::Manifest& job, machine::Printer printer);

/// For programs: an object with at least layers, swaps, swap_lower_bound, orders, seconds {total, swap, clean, expose,
/// move}, layer_seconds, resin_ml (ml by slot), solvent_ml, waste_ml, order (slots by layer), warnings.
[[nodiscard]] std::string plan_json(const Plan& plan);
/// For people: a table.
[[nodiscard]] std::string plan_text(const Plan& plan);
/// Filling instructions, one line per vat: "slot 2: semi-flex, at least 75 ml (12.3 ml printed, 2.1 ml wasted)", and
/// what to do about it.
[[nodiscard]] std::vector<std::string> vat_lines(const Plan& plan);
/// What must be in the vat before the print: "at least 75 ml", in whole millilitres.
[[nodiscard]] std::string needed_text(const VatUse& use);
/// "12.3 ml"; "under 0.1 ml" where that would be 0.0 and is not.
[[nodiscard]] std::string ml_text(double ml);
/// "1:02:03", rounded to seconds.
[[nodiscard]] std::string clock_text(double seconds);

}  // namespace pliant::plan
