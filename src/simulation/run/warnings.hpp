// Where the answer should not be trusted, in words.
#pragma once

#include <string>
#include <vector>

#include "simulation/model/model.hpp"
#include "simulation/run/trajectory.hpp"

namespace pliant::sim {

/// What is wrong with one state, a sentence each; without its step.
[[nodiscard]] std::vector<std::string> warnings_of(const Step& step);

/// What is odd about the robot before anything moves: its notes, and whether it passes through itself already.
[[nodiscard]] std::vector<std::string> warnings_at_rest(const Model& model);

/// What it means that the guide points at both ends of `segment` of a cable have met, where contact is off.
[[nodiscard]] std::string closed_gap_text(const std::string& cable, int segment);

/// Adds to the trajectory's warnings what is wrong with its steps: each kind once, with the number of the first step
/// and, where it is one of degree, how many there are.
void add_warnings(Trajectory& trajectory);

}  // namespace pliant::sim
