// Lengths of a machine as pages get them.
#pragma once

namespace pliant::studio {

[[nodiscard]] constexpr double mm(int um) {
    return um / 1e3;
}

}  // namespace pliant::studio
