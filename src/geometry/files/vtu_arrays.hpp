// The data arrays of a .vtu file: numbers as plain or zlib-compressed bytes, in base64 or raw.
// Format: VTK User's Guide, "XML file formats".
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "geometry/files/number_type.hpp"

namespace pliant::mesh {

/// From the value of the attribute "type", such as "Float64"; nothing if unknown.
[[nodiscard]] std::optional<NumberType> vtu_number_type(std::string_view name);

/// Settings shared by all arrays of a file.
struct VtuEncoding {
    bool big_endian = false;
    bool compressed = false;       ///< by zlib, in blocks
    std::size_t header_width = 4;  ///< bytes per number of an array's header
};

/// Where the bytes of an array begin; they may end before the text does.
struct VtuSource {
    std::string_view text;
    bool base64 = true;
};

/// All numbers of an array, decoded on all cores. Nothing if the data are damaged or truncated. Memory is bounded by
/// what the actual bytes can hold.
[[nodiscard]] std::optional<std::vector<double>> vtu_numbers(const VtuSource& source, const NumberType& type,
                                                             const VtuEncoding& encoding);

}  // namespace pliant::mesh
