// The shapes that are meshed and sliced: bodies without the air of chambers and gaps.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tri_mesh.hpp"
#include "geometry/shapes/solid.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// The drawn air of all chambers and gaps, which is cut out of the bodies. Enclosed air is already outside them.
[[nodiscard]] std::vector<mesh::Solid> drawn_air(const Robot& robot);

/// A drawn body without the air that is cut out of it.
[[nodiscard]] mesh::Solid without_air(const mesh::Solid& body, const std::vector<mesh::Solid>& air);

using Shape = std::variant<mesh::Solid, mesh::TriMesh>;

/// A body with its air cut out; triangles if nothing is cut, or if there are too many to cut. Defects and repairs of
/// its file are added to `notes`. Errors name the body and its line.
[[nodiscard]] Result<Shape> body_shape(const Robot& robot, const BodySpec& body, const std::vector<mesh::Solid>& air,
                                       std::vector<std::string>& notes);

}  // namespace pliant::robot
