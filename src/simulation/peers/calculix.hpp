// Runs CalculiX for comparison: writes a robot as an input deck (calculix_deck.hpp), runs its solver `ccx` (Debian
// package calculix-ccx) and reads the result. For tests and benchmarks only: nothing of CalculiX is linked.
#pragma once

#include <vector>

#include "base/core/error.hpp"
#include "simulation/model/model.hpp"
#include "simulation/peers/calculix_deck.hpp"

namespace pliant::sim::calculix {

struct Solution {
    std::vector<Vec3> displacement_m;  ///< (n, 3), nodes as in the description's mesh
    std::vector<Vec3> force_N;         ///< (n, 3), external forces: reactions at supports, loads elsewhere
    int increments = 0;
    int iterations = 0;
    double wall_s = 0;  ///< of the whole program: reading, solving, writing
};

/// Whether `ccx` is on the PATH.
[[nodiscard]] bool installed();

/// Runs `ccx` on one thread in a temporary folder, which is deleted afterwards.
[[nodiscard]] Result<Solution> solve(const Description& description, const Effort& effort = {});

/// Sum of the forces of a support on the robot.
[[nodiscard]] Vec3 support_force(const Solution& solution, const Support& support);

/// Mean displacement of an attachment's nodes, by its weights.
[[nodiscard]] Vec3 displacement(const Solution& solution, const Attachment& point);

}  // namespace pliant::sim::calculix
