// robot.glb: the moving robot as binary glTF 2.0, for any viewer, a browser or Blender. Metres, Y up.
// Format: Khronos glTF 2.0 specification (ISO/IEC 12113:2022).
#pragma once

#include <string>
#include <vector>

#include "presentation/draw/surface.hpp"
#include "presentation/report/simulation.hpp"

namespace pliant::report {

/// The file's bytes: one mesh per material that the outer surface shows, by its name, mesh "cables" with one
/// tube per cable, and an animation of `animation_s` seconds that runs through morph targets (positions and normals).
/// The steps are thinned out evenly to at most `target_limit` targets, the last always among them; fewer where the
/// targets would take more than about 24 MB.
[[nodiscard]] std::string robot_glb(const Simulation& simulation, const Surface& surface, std::size_t target_limit = 40,
                                    double animation_s = 3);

/// At most `limit` of the steps 1 .. count - 1 (0 is rest), evenly spread and always with the last; ascending.
[[nodiscard]] std::vector<std::size_t> thinned_steps(std::size_t count, std::size_t limit);

/// Radius at which a cable is drawn, in metres: what can be seen at the robot's size.
[[nodiscard]] double drawn_cable_radius(const Simulation& simulation);

}  // namespace pliant::report
