// Do the supports hold every part of a robot, or is one left that turns like a door?
#pragma once

#include <optional>
#include <string>

#include "simulation/model/model.hpp"

namespace pliant::sim {

/// Tets that share faces form parts; each part is taken as rigid. Supports hold its nodes, plates and shared nodes join
/// it to others: a support of one node or of nodes on a line leaves a part free to turn, and so does one shared edge or
/// corner. Rollers hold their directions, springs resist what changes their length. Returns in words which part can do
/// what, without a full stop; nothing if all parts are held. A part that is joined to nothing is left to
/// Model::create(), which names it.
[[nodiscard]] std::optional<std::string> free_motion(const Description& description);

}  // namespace pliant::sim
