// A robot's state as bytes: what is read back goes on with the same bits.
//
// CBOR (RFC 8949): a map with "format" and "version", and every vector of numbers as a byte string of little-endian
// doubles. A state is of use only to a model like the one it was written for: a digest of its mesh tells.
#pragma once

#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "simulation/stepper/stepper.hpp"

namespace pliant::sim {

inline constexpr int state_version = 2;  ///< 2: friction with memory

[[nodiscard]] std::string state_bytes(const Model& model, const RobotState& robot);

/// Errors: no state, one of another version or of another model, or numbers that no state of this model has; in one
/// line, without the name of a file.
[[nodiscard]] Result<RobotState> state_from_bytes(const Stepper& stepper, std::string_view bytes);

/// 16 hexadecimal digits that tell meshes apart, by their points, tets and regions.
[[nodiscard]] std::string mesh_digest(const mesh::TetMesh& mesh);

}  // namespace pliant::sim
