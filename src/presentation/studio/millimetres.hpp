// Lengths as pages get them.
#pragma once

namespace pliant::studio {

inline constexpr double mm_per_m = 1e3;

/// Of the whole micrometres of a machine.
[[nodiscard]] constexpr double mm(int um) {
    return um / 1e3;
}

}  // namespace pliant::studio
