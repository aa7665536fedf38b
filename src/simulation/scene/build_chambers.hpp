// Builds chambers: the walls of their air, from a surface file or from the mesh.
#pragma once

#include "simulation/actuators/attach.hpp"
#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

/// Adds all chambers to the draft's description; errors go to its problems. `attacher`: for the draft's bodies.
/// Precondition: materials, supports (which may close a mouth) and cables have been added.
void add_chambers(ModelDraft& draft, const sim::Attacher& attacher);

}  // namespace pliant::robot
