// Larger files and requests are refused.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pliant::studio {

inline constexpr std::uintmax_t largest_robot = 4 << 20;
inline constexpr std::uintmax_t largest_journal = 256 << 20;
inline constexpr std::size_t most_changes = 256;  ///< of values in one request

}  // namespace pliant::studio
