// Builds cables and springs: their guide points, and the gaps that close under cables of the thesis' model (T3.5).
#pragma once

#include "simulation/actuators/attach.hpp"
#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

/// Adds all cables to the draft's description; errors go to its problems. `attacher`: for the draft's bodies.
/// Preconditions: materials have been added, chambers have not (cables come first among the actuators).
void add_cables(ModelDraft& draft, const sim::Attacher& attacher);
/// Adds all springs, likewise.
void add_springs(ModelDraft& draft, const sim::Attacher& attacher);

}  // namespace pliant::robot
