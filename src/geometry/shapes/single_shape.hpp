// Solids that are one simple shape, wherever it is placed.
#pragma once

#include <optional>

#include "geometry/shapes/solid.hpp"

namespace pliant::mesh {

/// The sphere, or cylinder, that a solid is, after all translations and rotations. None for any other solid.
[[nodiscard]] std::optional<SphereSolid> single_sphere(const Solid& solid);
[[nodiscard]] std::optional<CylinderSolid> single_cylinder(const Solid& solid);

}  // namespace pliant::mesh
