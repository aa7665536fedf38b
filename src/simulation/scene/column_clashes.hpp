// Things whose names would give a table of results two columns of one name, or drive two actuators.
#pragma once

#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

/// Adds a problem for each thing that shares a column of steps.csv, or an input of the tables of the inverse, with
/// another one, and for a chamber named like a cable; the columns are those that docs/reference/results.md lists.
/// Precondition: the sensors have been added.
void check_columns(ModelDraft& draft);

}  // namespace pliant::robot
