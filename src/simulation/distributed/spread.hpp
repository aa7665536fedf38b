// From the robot that one rank has read to what each rank has of it.
#pragma once

#include "simulation/distributed/balance.hpp"
#include "simulation/distributed/ranks.hpp"

namespace pliant::sim::distributed {

/// `description` counts on root alone, where it is let go of as soon as it is spread. Errors: those of check(), too
/// many ranks for so small a mesh. Collective.
[[nodiscard]] Result<Balance> spread(const Ranks& ranks, Description description);

}  // namespace pliant::sim::distributed
