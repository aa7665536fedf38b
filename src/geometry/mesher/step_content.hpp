// The content of a STEP file.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

struct StepContent {
    std::vector<std::string> names;  ///< of the solids, as given by the CAD program; "" if not named
    std::vector<TriMesh> surfaces;   ///< one per solid, normals outwards, chords of 1/32 of a turn
};

}  // namespace pliant::mesh
