// Bodies that only one mesh of all of them can join.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesher/mesher.hpp"

namespace pliant::mesh {

struct TouchingGroup {
    std::vector<std::size_t> bodies;  ///< ascending
    std::vector<TriMesh> surfaces;    ///< of each of them; solids as triangles
};

/// Groups of two or more bodies, among them a surface of triangles, that hang together: where faces come within a
/// hundredth of `size`, or cut through each other, as samples `size` apart on all faces tell. Errors: a solid that
/// cannot be tessellated.
[[nodiscard]] Result<std::vector<TouchingGroup>> touching_groups(std::span<const BodyGeometry> bodies, double size);

}  // namespace pliant::mesh
