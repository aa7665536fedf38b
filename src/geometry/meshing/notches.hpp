// Implements crossed_notches() of mesher/notches.hpp inside the worker process; convex hulls by CGAL.
#pragma once

#include <vector>

#include "geometry/mesher/notches.hpp"

namespace pliant::mesh::kernel {

/// See mesher/notches.hpp.
[[nodiscard]] std::vector<Notch> crossed_notches(const TriMesh& surface, const std::vector<Vec3>& path);

}  // namespace pliant::mesh::kernel
