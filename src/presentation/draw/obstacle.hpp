// The rigid things that the robot may touch, as the report draws and exports them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/core/vec3.hpp"
#include "geometry/mesh/tri_mesh.hpp"
#include "simulation/model/model.hpp"
#include "simulation/run/trajectory.hpp"

namespace pliant::report {

/// A surface that does not change its shape; at step s it is at rest + offset_m[s], turned where it is an object.
struct Obstacle {
    std::string name;
    mesh::TriMesh surface;       ///< metres, at its rest place
    bool open = false;           ///< a piece of a plane: seen from in front only, and without a shadow
    std::vector<Vec3> offset_m;  ///< (steps)
    /// (steps) of an object: how it has turned about `pivot_m` before it is shifted, unit quaternion w, x, y, z.
    std::vector<std::array<double, 4>> rotation{};
    Vec3 pivot_m{};

    /// The points of the surface at a step.
    [[nodiscard]] std::vector<Vec3> points_at(std::size_t step) const;
};

/// The obstacles of a model along a result, then its objects. A half-space becomes a disc on its surface, before the
/// robot and somewhat larger than its motion.
[[nodiscard]] std::vector<Obstacle> obstacles_of(const sim::Model& model, const sim::Trajectory& result);

/// In two rings around its centre, which is the first point. `normal` is of length 1; the disc's points the same way.
[[nodiscard]] mesh::TriMesh disc(const Vec3& center, const Vec3& normal, double radius_m);

}  // namespace pliant::report
