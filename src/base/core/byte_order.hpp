// Reversing the byte order of numbers.
#pragma once

#include <cstdint>

namespace pliant {

[[nodiscard]] constexpr std::uint32_t byte_swapped(std::uint32_t v) {
    return v >> 24U | (v >> 8U & 0xff00U) | (v << 8U & 0xff0000U) | v << 24U;
}
[[nodiscard]] constexpr std::uint64_t byte_swapped(std::uint64_t v) {
    return std::uint64_t{byte_swapped(static_cast<std::uint32_t>(v))} << 32U |
           byte_swapped(static_cast<std::uint32_t>(v >> 32U));
}

}  // namespace pliant
