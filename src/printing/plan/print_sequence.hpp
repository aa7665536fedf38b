// The whole print as a sequence of commands: homing, the first vat, every layer, storing the last vat; and its
// duration, without writing any command.
#pragma once

#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/plan.hpp"
#include "printing/plan/sequence.hpp"

namespace pliant::plan {

/// Needs `order`, `vats` and `vat_of_image` of the plan. The printer must outlive the result. If `timeline` is given,
/// no text is written, and its stretches and visits are filled in.
[[nodiscard]] Sequence print_sequence(const Plan& plan, const job::Manifest& job, const machine::Printer& printer,
                                      JobTimeline* timeline = nullptr);

struct PrintTimes {
    Seconds all;                  ///< including homing and the final way up
    std::vector<Seconds> layers;  ///< of each layer, including vat changes before and within it
};

/// The durations of print_sequence() up to rounding. Repetitions (the swaps of a pair, the strokes of a layer) are
/// computed once: about 100 ns per vat and layer.
[[nodiscard]] PrintTimes print_times(const Plan& plan, const job::Manifest& job, const machine::Printer& printer);

}  // namespace pliant::plan
