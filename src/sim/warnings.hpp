// Where the answer should not be trusted, in words.
#pragma once

#include <string>
#include <vector>

#include "sim/trajectory.hpp"

namespace pliant::sim {

/// What is wrong with one state, a sentence each; without its step.
[[nodiscard]] std::vector<std::string> warnings_of(const Step& step);

/// What it means that the robot passes through itself at `place_m` before anything moves.
[[nodiscard]] std::string warning_at_rest(const Vec3& place_m, bool contact);

/// Adds to the trajectory's warnings what is wrong with its steps: each kind once, with the number of the first step
/// and, where it is one of degree, how many there are.
void add_warnings(Trajectory& trajectory);

}  // namespace pliant::sim
