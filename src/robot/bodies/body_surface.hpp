// The triangles of a body that is read from a file.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tri_mesh.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

struct BodyTriangles {
    mesh::TriMesh mesh;              ///< in length units
    std::vector<std::string> notes;  ///< defects found or repaired; each begins with the file's name
};

/// Reads STL, OBJ, PLY, OFF (in length units) or 3MF (which has its own unit), recognised by content, and applies the
/// placement; `unit_m`: metres per length unit. Errors name the file and, for a missing part, the parts that exist. A
/// 3MF file of several materials needs a part.
[[nodiscard]] Result<BodyTriangles> read_triangles(const SurfaceFile& file, double unit_m);

}  // namespace pliant::robot
