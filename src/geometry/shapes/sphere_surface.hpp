// The surface of a sphere as an even polyhedron, without a mesher.
#pragma once

#include "geometry/mesh/tri_mesh.hpp"
#include "geometry/shapes/solid.hpp"

namespace pliant::mesh {

/// The triangles of an icosahedron, divided evenly and moved out to the sphere (Fuller's geodesic polyhedron): their
/// corners lie on it, and they deviate from it by `tolerance` (above zero) at most, with up to 200,000 triangles.
[[nodiscard]] TriMesh sphere_surface(const SphereSolid& sphere, double tolerance);

}  // namespace pliant::mesh
