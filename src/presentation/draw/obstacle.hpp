// The obstacles and objects of a robot, as the report draws and exports them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/core/vec3.hpp"
#include "geometry/mesh/tri_mesh.hpp"
#include "simulation/model/model.hpp"
#include "simulation/run/trajectory.hpp"

namespace pliant::report {

/// A rigid surface; its position at step s is rest + offset_m[s], after a rotation for objects.
struct Obstacle {
    std::string name;
    mesh::TriMesh surface;       ///< metres, at its rest position
    bool open = false;           ///< a piece of a plane: visible from the front only, without a shadow
    std::vector<Vec3> offset_m;  ///< (steps)
    /// (steps) for an object: rotation about `pivot_m` before the shift, unit quaternion w, x, y, z.
    std::vector<std::array<double, 4>> rotation{};
    Vec3 pivot_m{};

    /// The points of the surface at a step.
    [[nodiscard]] std::vector<Vec3> points_at(std::size_t step) const;
};

/// The obstacles of a model over a result, followed by its objects. A half-space is drawn as a disc on its surface, in
/// front of the robot and somewhat larger than its motion.
[[nodiscard]] std::vector<Obstacle> obstacles_of(const sim::Model& model, const sim::Trajectory& result);

/// A disc of two rings around its centre, which is the first point. `normal` is a unit vector and becomes that of the
/// disc.
[[nodiscard]] mesh::TriMesh disc(const Vec3& center, const Vec3& normal, double radius_m);

}  // namespace pliant::report
