// Notes on bodies and chambers that are allowed, but hardly meant.
#pragma once

#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "geometry/mesher/mesher.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// Defects and repairs in the surface files of chambers, obstacles, objects and selectors, which are read again when
/// the model is built.
[[nodiscard]] std::vector<std::string> notes_on_surfaces(const Robot& robot);

/// Cuts that cut nothing, and a mesh size that is longer than the robot.
[[nodiscard]] std::vector<std::string> notes_on_shapes(const Robot& robot,
                                                       const std::vector<mesh::BodyGeometry>& bodies);

/// Bodies that stay apart by so little that they were probably drawn to touch. Gaps up to `closed` wide have notes of
/// their own; who gives mesh.close_gaps has thought of them.
[[nodiscard]] std::vector<std::string> notes_on_gaps(const Robot& robot, const mesh::TetMesh& mesh, double closed);

/// Drawn bodies that overlap, in the words of the mesher.
[[nodiscard]] std::vector<std::string> overlap_notes(const Robot& robot, const Progress& progress);

}  // namespace pliant::robot
