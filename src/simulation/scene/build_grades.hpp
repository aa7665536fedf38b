// Bodies that change from one material to another.
#pragma once

#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

/// Steps from one material to the other: each tet takes that of the share in its middle.
inline constexpr int grades = 20;

/// Gives the tets of graded bodies mixtures of both materials, each of one grade. Precondition: materials were added.
void add_grades(ModelDraft& draft);

}  // namespace pliant::robot
