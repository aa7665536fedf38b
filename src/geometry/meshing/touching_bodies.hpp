// Groups of bodies that must be meshed together.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesher/mesher.hpp"

namespace pliant::mesh {

struct TouchingGroup {
    std::vector<std::size_t> bodies;  ///< ascending
    std::vector<TriMesh> surfaces;    ///< one per body; solids as triangles
};

/// Groups of two or more connected bodies, at least one of them a triangle surface. Bodies are connected where faces
/// come within a hundredth of `size` or intersect, judged by samples `size` apart on all faces. Errors: a solid that
/// cannot be tessellated.
[[nodiscard]] Result<std::vector<TouchingGroup>> touching_groups(std::span<const BodyGeometry> bodies, double size);

}  // namespace pliant::mesh
