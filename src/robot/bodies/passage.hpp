// Where a cable passes through the gaps that the thesis' gap elements close (T3.5).
#pragma once

#include <vector>

#include "base/core/vec3.hpp"
#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::robot {

/// The part of a polyline that lies inside one region of a mesh of straight tets.
struct Passage {
    double length = 0;
    Vec3 direction;  ///< mean direction of the passage, of length 1; zero if there is none
    Vec3 center;     ///< mean of its points
};
/// In the unit of the mesh and of `points`. Cost: proportional to tets times points.
[[nodiscard]] Passage passage_through(const mesh::TetMesh& mesh, int region, const std::vector<Vec3>& points);

}  // namespace pliant::robot
