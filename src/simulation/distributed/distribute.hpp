// Distributes the robot, which root has read, over the ranks.
#pragma once

#include "simulation/distributed/distributed_equilibrium.hpp"
#include "simulation/distributed/ranks.hpp"

namespace pliant::sim::distributed {

/// `description` is used on root alone, and freed there as soon as it is distributed. Errors: those of check(), and
/// more ranks than the mesh has parts for. Collective.
[[nodiscard]] Result<DistributedEquilibrium> distribute(const Ranks& ranks, Description description);

}  // namespace pliant::sim::distributed
