// robot.glb: the moving robot as binary glTF 2.0, for any viewer, a browser or Blender. Metres, Y up.
// Format: Khronos glTF 2.0 specification (ISO/IEC 12113:2022).
#pragma once

#include <string>
#include <vector>

#include "presentation/draw/surface.hpp"
#include "presentation/report/simulation.hpp"

namespace pliant::report {

/// The bytes of the file: one mesh per material visible on the outer surface, with its name, a mesh "cables" with one
/// tube per cable, and an animation of `animation_s` seconds through morph targets (positions and normals). The steps
/// are thinned out evenly to at most `target_limit` targets, always including the last; fewer if the targets would take
/// more than about 24 MB.
[[nodiscard]] std::string robot_glb(const Simulation& simulation, const Surface& surface, std::size_t target_limit = 40,
                                    double animation_s = 3);

/// At most `limit` of the steps 1 .. count - 1 (0 is rest), evenly spread, ascending, always including the last.
[[nodiscard]] std::vector<std::size_t> thinned_steps(std::size_t count, std::size_t limit);

/// Radius at which a cable is drawn, in metres: visible at the robot's size.
[[nodiscard]] double drawn_cable_radius(const Simulation& simulation);

}  // namespace pliant::report
