// The whole print as a sequence of commands: homing, the first vat, every layer, the last vat put away; and the time of
// it, without writing a single command.
#pragma once

#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/plan.hpp"
#include "printing/plan/sequence.hpp"

namespace pliant::plan {

/// Needs `order`, `vats` and `vat_of_image` of the plan. The printer must outlive the result. With `timeline`, no text
/// is written, and its stretches and visits are filled in.
[[nodiscard]] Sequence print_sequence(const Plan& plan, const job::Manifest& job, const machine::Printer& printer,
                                      JobTimeline* timeline = nullptr);

struct PrintTimes {
    Seconds all;                  ///< with homing and the way up at the end
    std::vector<Seconds> layers;  ///< what each layer takes, the changes of vat before and within it included
};

/// The seconds of print_sequence() up to rounding. What repeats (the swaps of a pair, the strokes of a layer) is
/// reckoned once: some 100 ns for every vat of every layer.
[[nodiscard]] PrintTimes print_times(const Plan& plan, const job::Manifest& job, const machine::Printer& printer);

}  // namespace pliant::plan
