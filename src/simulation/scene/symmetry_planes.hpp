// Planes of symmetry, at which a mesh of half a robot ends.
#pragma once

#include <span>
#include <vector>

#include "simulation/actuators/attach.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::robot {

/// One for each support without motion that holds nodes of one plane along its normal only. A frictionless table is
/// such a plane, too: it has the same effect. Precondition: supports have been added.
[[nodiscard]] std::vector<sim::SymmetryPlane> symmetry_planes(const sim::Description& description);
/// Those in which a cable or a spring lies as a whole, so that it pulls along the plane. `points` in metres.
[[nodiscard]] std::vector<sim::SymmetryPlane> planes_of_path(const sim::Description& description,
                                                             std::span<const Vec3> points);
/// Those along which a force at a point acts.
[[nodiscard]] std::vector<sim::SymmetryPlane> planes_of_force(const sim::Description& description, const Vec3& point,
                                                              const Vec3& force);

}  // namespace pliant::robot
