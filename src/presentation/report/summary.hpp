// summary.json: the results of a simulation in machine-readable form. docs/reference/results.md lists the keys.
#pragma once

#include <string>

#include "presentation/report/simulation.hpp"

namespace pliant::report {

/// Lengths in mm, forces in N, pressures in kPa, volumes in mm^3. The rest state is under "rest", the steps of the
/// program, counted from 1, under "steps". `indent` < 0 writes one line. Numbers that are not finite become null.
[[nodiscard]] std::string summary_json(const Simulation& simulation, int indent = 2);

}  // namespace pliant::report
