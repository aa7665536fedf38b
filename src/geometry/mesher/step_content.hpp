// What a STEP file holds.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

struct StepContent {
    std::vector<std::string> names;  ///< of the solids, as the program that drew them called them; "" where it did not
    std::vector<TriMesh> surfaces;   ///< of each, normals outwards, chords of 1/32 of a turn
};

}  // namespace pliant::mesh
