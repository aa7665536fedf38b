// Builds joints between bodies, plates, objects and the world.
#pragma once

#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

/// Adds all joints to the draft's description; errors go to its problems. Preconditions: materials, plates and objects
/// have been added.
void add_joints(ModelDraft& draft);

}  // namespace pliant::robot
