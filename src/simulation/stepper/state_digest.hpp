// What a state says of the robot that it belongs to.
#pragma once

#include <string>

#include "simulation/parts/description.hpp"

namespace pliant::sim {

inline constexpr const char* state_format_name = "pliant state";

/// Identifies what is attached to the mesh, by names and places. Constants, targets and loads do not count: with others
/// a state is where the next step begins.
[[nodiscard]] std::string parts_digest(const Description& d);

}  // namespace pliant::sim
