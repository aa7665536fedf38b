// Lengths as pages get them.
#pragma once

#include "presentation/report/units.hpp"

namespace pliant::studio {

using report::mm_per_m;

/// Of the whole micrometres of a machine.
[[nodiscard]] constexpr double mm(int um) {
    return um / 1e3;
}

}  // namespace pliant::studio
