// The surface of a cylinder as a prism, without a mesher.
#pragma once

#include <optional>

#include "geometry/mesh/tri_mesh.hpp"
#include "geometry/shapes/solid.hpp"

namespace pliant::mesh {

/// The surface of a solid that is one cylinder, placed anywhere: a prism whose edges lie on the cylinder and whose
/// sides deviate from it by `tolerance` (above zero) at most, with 24 to 2000 sides. None for any other solid.
///
/// Sides as long as the cylinder are fewer triangles than a mesher makes, and even: what slides around it meets the
/// same ridges everywhere, and no force along it.
[[nodiscard]] std::optional<TriMesh> rod_surface(const Solid& solid, double tolerance);

}  // namespace pliant::mesh
