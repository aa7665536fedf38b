// Fields derived from a deformed state, one value per tet (the mean over its integration points).
#pragma once

#include <span>
#include <vector>

#include "core/vec3.hpp"

namespace pliant::sim {

class Model;

struct Fields {
    std::vector<double> J;                  ///< (m), det F
    std::vector<double> von_mises_Pa;       ///< (m), of the Cauchy stress
    std::vector<double> max_stretch;        ///< (m), largest principal stretch
    std::vector<double> energy_density_Pa;  ///< (m), J/m^3 of rest volume; 0 where the law has no energy
};

/// `positions` (n, 3) in metres.
[[nodiscard]] Fields compute_fields(const Model& model, std::span<const Vec3> positions);

}  // namespace pliant::sim
