// What `pliant-mpi simulate` writes at its end, in the formats of `pliant simulate`.
#pragma once

#include <filesystem>
#include <string>

#include "presentation/report/simulation.hpp"

namespace pliant::app {

/// summary.json, steps.csv, markers.csv, iterations.csv and, from the folder `kept`, frames. Replaces `folder` whole,
/// or leaves it.
[[nodiscard]] Status write_results(const std::filesystem::path& folder, const std::filesystem::path& kept,
                                   const report::Simulation& simulation);

/// The last state, in a few lines.
void print_summary(const report::Simulation& simulation, int ranks);

}  // namespace pliant::app
