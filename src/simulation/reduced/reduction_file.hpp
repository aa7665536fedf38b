// Stores a reduction, so that it need not be made again.
//
// CBOR (RFC 8949): a map with "format" and "version", and every list of numbers as a byte string of little-endian
// values. It can only be used with the robot it was made for: `origin` tells robots apart.
#pragma once

#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "simulation/reduced/reduced_model.hpp"

namespace pliant::sim::reduced {

inline constexpr int reduction_version = 1;

[[nodiscard]] std::string reduction_bytes(const Reduction& reduction, const std::string& origin);

/// Errors: not a reduction, another version, of another origin or model, or damaged; in one line, without the name of
/// a file.
[[nodiscard]] Result<Reduction> reduction_from_bytes(const Model& model, std::string_view bytes,
                                                     const std::string& origin);

}  // namespace pliant::sim::reduced
