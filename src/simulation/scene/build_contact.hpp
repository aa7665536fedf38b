// Builds the contact rules from the robot file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/mesh/tet_mesh.hpp"
#include "robot/description/robot.hpp"
#include "simulation/model/model.hpp"

namespace pliant::robot {

/// `bodies`: the tets that carry material, metres. If the file has neither [contact] nor an obstacle, self-contact
/// becomes active once the robot would intersect itself. Empty if self-contact is switched off and there is no
/// obstacle. Errors name the obstacle or the key, and its line.
[[nodiscard]] Result<std::optional<sim::ContactRules>> build_contact(const Robot& robot, const mesh::TetMesh& bodies);

/// Lengths that are possible, but hardly meant. `rules`: of this robot.
[[nodiscard]] std::vector<std::string> notes_on_contact(const Robot& robot, const mesh::TetMesh& bodies,
                                                        const sim::ContactRules& rules);

/// Adds the objects, with four nodes each, to a description that has contact. Errors name the object and its line.
[[nodiscard]] Status add_objects(const Robot& robot, sim::Description& description);

}  // namespace pliant::robot
