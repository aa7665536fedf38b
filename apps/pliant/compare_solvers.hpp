// Compares solvers on one robot: the benefit of each change to the thesis' iteration.
#pragma once

#include <string>
#include <vector>

#include "command.hpp"
#include "simulation/run/simulate.hpp"

namespace pliant::app {

/// "newton,anderson" -> the solvers in that order. Errors name the invalid one.
[[nodiscard]] Result<std::vector<sim::Solver>> read_solvers(const std::string& list);

/// Runs the program with each solver in turn, prints the table and, if `folder` is not empty, writes comparison.json,
/// comparison.csv, convergence.csv and convergence.png there. The exit status: failed if no solver finished.
[[nodiscard]] Result<int> compare_solvers(const sim::Model& model, const sim::Program& program,
                                          const std::vector<sim::Solver>& solvers, const std::string& folder,
                                          const Output& output);

}  // namespace pliant::app
