// The results of `pliant-mpi simulate`, in the formats of `pliant simulate`.
#pragma once

#include <filesystem>
#include <string>

#include "presentation/report/simulation.hpp"

namespace pliant::app {

/// summary.json, steps.csv, markers.csv, iterations.csv and, from the folder `kept`, frames. Replaces the whole
/// `folder`, or leaves it unchanged.
[[nodiscard]] Status write_results(const std::filesystem::path& folder, const std::filesystem::path& kept,
                                   const report::Simulation& simulation);

/// The last state in a few lines.
void print_summary(const report::Simulation& simulation, int ranks);

}  // namespace pliant::app
