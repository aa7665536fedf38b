// Notches: the empty space between two faces where a cable leaves the material and enters it again. They close when the
// cable is pulled.
#pragma once

#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tri_mesh.hpp"
#include "geometry/shapes/solid.hpp"

namespace pliant::mesh {

/// One notch, before the bodies are subtracted from it.
struct Notch {
    Solid hull;     ///< convex; at round walls it extends into the material
    Vec3 point;     ///< on the cable's path, halfway through the notch
    Vec3 from, to;  ///< where the path leaves the material and enters it again
};

/// The notches that a path crosses, in path order: each is the convex hull of the face it leaves and the face it
/// enters, of each the part that faces along the path. A face over 1.5 times as large as the other is cut to the
/// other's extent. `surface`: closed, of all bodies together, normals outwards, at least 32 chords per turn on round
/// faces. Cost: triangles times crossings. Errors: those of ask_mesher().
[[nodiscard]] Result<std::vector<Notch>> crossed_notches(const TriMesh& surface, const std::vector<Vec3>& path);

}  // namespace pliant::mesh
