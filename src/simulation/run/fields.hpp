// Fields derived from a deformed state: one value per tet (the mean over its integration points), or one per node.
#pragma once

#include <span>
#include <vector>

#include "base/core/vec3.hpp"

namespace pliant::sim {

class Model;
struct Step;

struct Fields {
    std::vector<double> J;                  ///< (m), det F
    std::vector<double> von_mises_Pa;       ///< (m), of the Cauchy stress
    std::vector<double> max_stretch;        ///< (m), largest principal stretch
    std::vector<double> energy_density_Pa;  ///< (m), J/m^3 of rest volume; 0 if the law has no energy
};

/// `positions` (n, 3) in metres.
[[nodiscard]] Fields compute_fields(const Model& model, std::span<const Vec3> positions);

/// Positions in the format of contact::Contact, (3 nodes): the robot's nodes, then the obstacles at their positions at
/// program time `time`. Precondition: something can touch.
[[nodiscard]] std::vector<double> contact_nodes(const Model& model, std::span<const Vec3> positions, double time);

/// Normal pressure of all contacts at the nodes after a step, (n) Pa: 0 inside and where nothing is near. Empty if
/// nothing can touch.
[[nodiscard]] std::vector<double> contact_pressure(const Model& model, const Step& step);

}  // namespace pliant::sim
