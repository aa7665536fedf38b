// The empty space between two faces that a cable leaves and enters again: what closes when it is pulled.
#pragma once

#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tri_mesh.hpp"
#include "geometry/shapes/solid.hpp"

namespace pliant::mesh {

/// One notch, before the bodies are taken away from it.
struct Notch {
    Solid hull;     ///< convex; where the walls are round it reaches into the material
    Vec3 point;     ///< of the cable's path, halfway through the notch
    Vec3 from, to;  ///< where the path leaves the material and where it enters again
};

/// The notches that a path crosses, in its order: the convex hull of the face it leaves and the face it enters, each as
/// far as it looks along the path. A face more than half as large again as the other counts only as far as that one
/// reaches. `surface`: closed, of all bodies together, normals outwards, round faces in 32 chords a turn or more. Cost:
/// triangles times crossings. Errors: those of ask_mesher().
[[nodiscard]] Result<std::vector<Notch>> crossed_notches(const TriMesh& surface, const std::vector<Vec3>& path);

}  // namespace pliant::mesh
