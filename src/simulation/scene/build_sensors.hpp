// Sensors of the robot file on the mesh.
#pragma once

#include "simulation/actuators/attach.hpp"
#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

/// Adds all sensors to the draft's description, or to its problems. Preconditions: objects and contact are there.
/// `attacher`: of the draft's bodies.
void add_sensors(ModelDraft& draft, const sim::Attacher& attacher);

}  // namespace pliant::robot
