// The triangles of a body that comes from a file.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tri_mesh.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

struct BodyTriangles {
    mesh::TriMesh mesh;              ///< in length units
    std::vector<std::string> notes;  ///< what was odd or mended; each begins with the file's name
};

/// STL, OBJ, PLY, OFF (in length units) or 3MF (which says its own unit), by content, put where the placement says;
/// `unit_m`: metres per length unit.
/// Errors name the file, and for a part that is not there those that are. A 3MF file of several materials needs a part.
[[nodiscard]] Result<BodyTriangles> read_triangles(const SurfaceFile& file, double unit_m);

}  // namespace pliant::robot
