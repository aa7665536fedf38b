// Serialises a robot's state; a restored state continues with the same bits.
//
// CBOR (RFC 8949): a map with "format" and "version", and every vector of numbers as a byte string of little-endian
// doubles; then a checksum. A state can only be used with a model like the one it was written for: digests of its mesh
// and of the names and places of supports, actuators, springs and joints are checked. Constants and loads may differ.
#pragma once

#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "simulation/stepper/stepper.hpp"

namespace pliant::sim {

inline constexpr int state_version = 2;  ///< 2: friction with memory

[[nodiscard]] std::string state_bytes(const Model& model, const RobotState& robot);

/// Errors: not a state, another version or another model, or values that are invalid for this model; in one line,
/// without the name of a file.
[[nodiscard]] Result<RobotState> state_from_bytes(const Stepper& stepper, std::string_view bytes);

/// 16 hexadecimal digits that identify a mesh by its points, tets and regions.
[[nodiscard]] std::string mesh_digest(const mesh::TetMesh& mesh);

}  // namespace pliant::sim
