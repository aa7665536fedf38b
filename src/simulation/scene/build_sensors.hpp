// Builds the sensors of the robot file.
#pragma once

#include "simulation/actuators/attach.hpp"
#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

/// Adds all sensors to the draft's description; errors go to its problems. Preconditions: objects and contact have been
/// added. `attacher`: for the draft's bodies.
void add_sensors(ModelDraft& draft, const sim::Attacher& attacher);

}  // namespace pliant::robot
