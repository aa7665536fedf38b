// How thick are the walls of a body?
#pragma once

#include <vector>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

struct WallSample {
    Vec3 at;           ///< middle of a triangle of the surface
    double thickness;  ///< from there straight into the material to the face opposite
    double edge;       ///< mean edge length of the triangle
};

/// One sample for each triangle of a closed surface behind which a face looks the other way, within 45 degrees: beside
/// a sharp edge there is no wall. Cost: about n log n.
[[nodiscard]] std::vector<WallSample> wall_samples(const TriMesh& surface);

}  // namespace pliant::mesh
