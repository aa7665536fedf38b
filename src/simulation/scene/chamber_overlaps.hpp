// Chambers that claim the same air.
#pragma once

#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

/// Adds a problem for each chamber whose air is, at least in part, that of one before it in the file. Precondition:
/// every chamber of the robot has been added to the description.
void check_overlaps(ModelDraft& draft);

}  // namespace pliant::robot
