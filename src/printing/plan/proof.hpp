// Verifies that a program prints a job: the machine's actions, line by line, against the manifest.
#pragma once

#include <string_view>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/plan.hpp"

namespace pliant::plan {

/// Replays `gcode` on the machine's interlocks and fails unless
///   - every image of every layer is exposed exactly once, layer by layer, for the time in the manifest, under its name
///     there, at the layer's height, over a vat that holds its material's resin and has not run empty,
///   - the part waits before and after each exposure and is sheared and lifted after it as the printer file requires,
///   - between two vats the part is cleaned and dried, for the required time and with the required strokes,
///   - during an exposure no fan runs and no motor may be disabled,
///   - whatever is switched on has a line that tells the host how to switch it off (`;@stop`),
///   - the program ends with the part cleaned and clear of everything, all vats in their places, pump and fans off.
/// The program need not be the planner's. The error is one line: "G-code line N: layer K: ...". `plan` must be the
/// result of make_plan(job, printer). Cost: linear in the lines.
[[nodiscard]] Status prove_program(std::string_view gcode, const Plan& plan, const job::Manifest& job,
                                   const machine::Printer& printer);

}  // namespace pliant::plan
