// Proof that a program prints a job: what the machine will do, line by line, against what the manifest asks for.
#pragma once

#include <string_view>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/plan.hpp"

namespace pliant::plan {

/// Replays `gcode` on the machine's interlocks and fails unless
///   - every image of every layer is lit exactly once, layer by layer, as long as the manifest says, under the name
///     that it has there, at the layer's height, over a vat that holds its material's resin and has not run dry,
///   - the part rests before and after each light and is loosened and lifted after it as the printer file asks,
///   - between two vats the part is cleaned and dried: as long as asked for, with the strokes that are asked for,
///   - during a light no fan runs and no motor may let go,
///   - what is switched on has a line that tells the host how to switch it off (`;@stop`),
///   - the program ends with the part cleaned and clear of everything, all vats in their places, pump and fans off.
/// The program need not be the planner's. The error is one line: "G-code line N: layer K: ...". `plan` must be that of
/// make_plan(job, printer). Cost: linear in the lines.
[[nodiscard]] Status prove_program(std::string_view gcode, const Plan& plan, const job::Manifest& job,
                                   const machine::Printer& printer);

}  // namespace pliant::plan
