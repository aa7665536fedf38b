// Volume, centroid and second moments of the region inside a closed surface.
#pragma once

#include <Eigen/Core>
#include <array>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

struct MassProperties {
    double volume = 0;  ///< in the mesh's unit, cubed; negative if the surface is inside out
    Vec3 centre;
    /// Integral of (x − c)(x − c)ᵀ over the volume.
    Eigen::Matrix3d second_moment = Eigen::Matrix3d::Zero();
};

/// Exact for the polyhedron. Precondition: the surface is closed.
[[nodiscard]] MassProperties mass_properties(const TriMesh& surface);

/// Four points that carry a quarter of the mass each and have the centre of mass and the inertia of the body (every
/// rigid body has such points: Routh 1905, Dynamics of a System of Rigid Bodies I, article 40). Precondition: volume >
/// 0.
[[nodiscard]] std::array<Vec3, 4> equal_mass_points(const MassProperties& body);

}  // namespace pliant::mesh
