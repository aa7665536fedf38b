// How a file of bytes stores its numbers.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace pliant::mesh {

struct NumberType {
    std::size_t width = 0;  ///< bytes
    bool floating = false;
    bool is_signed = true;
};

/// The number of which `bits` are the bytes, the most significant first. Precondition: a width of 1, 2, 4 or 8 bytes.
[[nodiscard]] inline double number_of_bits(const NumberType& type, std::uint64_t bits) {
    if (type.floating && type.width == 4) return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    if (type.floating) return std::bit_cast<double>(bits);
    if (!type.is_signed) return static_cast<double>(bits);
    const std::uint64_t sign = std::uint64_t{1} << (8 * type.width - 1);
    return static_cast<double>(static_cast<std::int64_t>((bits ^ sign) - sign));
}

}  // namespace pliant::mesh
