// Builds graded bodies, which change from one material to another.
#pragma once

#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

/// Number of steps from one material to the other: each tet takes the mixture at its centre.
inline constexpr int grades = 20;

/// Assigns mixtures of both materials, one per grade, to the tets of graded bodies. Precondition: materials were added.
void add_grades(ModelDraft& draft);

}  // namespace pliant::robot
