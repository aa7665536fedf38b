// Serialises a piece of a workspace, so that a search can be resumed.
#pragma once

#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "simulation/inverse/workspace.hpp"

namespace pliant::sim::inverse {

[[nodiscard]] std::string piece_bytes(const WorkspacePiece& piece);
/// Errors: damaged.
[[nodiscard]] Result<WorkspacePiece> piece_from_bytes(std::string_view bytes);

}  // namespace pliant::sim::inverse
