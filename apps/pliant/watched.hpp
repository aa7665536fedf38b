// Progress and cancellation of the library's long calls in a command.
#pragma once

#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "pliant/simulation.hpp"

namespace pliant::app {

/// Shows progress, and ends the call after a signal. `progress` must outlive it.
[[nodiscard]] Watch watch_of(Progress& progress);

/// The model of a robot file, changed by `assignments` ("KEY=VALUE"), made while nothing is written yet: a signal
/// meanwhile ends the program, and afterwards makes interrupted() true. Throws as Robot::load() and Model do.
[[nodiscard]] Model load_model(const std::string& robot, const std::vector<std::string>& assignments,
                               const Watch& watch);

}  // namespace pliant::app
