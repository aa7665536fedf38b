// Wall thickness of bodies.
#pragma once

#include <vector>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

struct WallSample {
    Vec3 at;           ///< centroid of a triangle of the surface
    double thickness;  ///< from there along the inward normal to the opposite face
    double edge;       ///< mean edge length of the triangle
};

/// One sample for each triangle of a closed surface whose opposite face has a normal within 45 degrees of the opposite
/// direction: next to a sharp edge there is no wall. Cost: about n log n.
[[nodiscard]] std::vector<WallSample> wall_samples(const TriMesh& surface);

}  // namespace pliant::mesh
