// Checks whether the supports hold every part of a robot, or leave one free to rotate like a door.
#pragma once

#include <optional>
#include <string>

#include "simulation/model/model.hpp"

namespace pliant::sim {

/// Parts are sets of tets connected through faces; each is treated as rigid. Supports hold its nodes; plates and shared
/// nodes join it to others. A support of one node or of collinear nodes leaves a part free to rotate, and so does one
/// shared edge or corner. Rollers hold their directions, springs resist a change of length. Returns a description of
/// the free part and its motion, without a full stop; empty if all parts are held. A part that is not connected to
/// anything is left to Model::create(), which names it.
[[nodiscard]] std::optional<std::string> free_motion(const Description& description);

}  // namespace pliant::sim
