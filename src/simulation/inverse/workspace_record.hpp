// Serialises a piece of a workspace, so that a search can be resumed.
#pragma once

#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "simulation/inverse/workspace.hpp"

namespace pliant::sim::inverse {

/// With a checksum. `identity`: of which search it is, and which of its pieces.
[[nodiscard]] std::string piece_bytes(const WorkspacePiece& piece, const std::string& identity);
/// Errors: damaged; of another identity.
[[nodiscard]] Result<WorkspacePiece> piece_from_bytes(std::string_view bytes, const std::string& identity);

}  // namespace pliant::sim::inverse
