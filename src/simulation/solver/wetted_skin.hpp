// Which part of a robot's skin a fluid wets.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "simulation/model/held_nodes.hpp"

namespace pliant::sim {

/// Of the triangles of a skin those that a fluid wets: all but the ones that a support holds along their normal and
/// lets slide, as on a plane of symmetry, where the other half of the robot goes on. `rest`: (3n) m.
[[nodiscard]] std::vector<std::array<int, 3>> wetted(std::vector<std::array<int, 3>> skin, std::span<const double> rest,
                                                     const HeldNodes& held);

}  // namespace pliant::sim
