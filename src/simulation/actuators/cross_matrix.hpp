// The cross product as a matrix.
#pragma once

#include "base/linalg/small.hpp"

namespace pliant::sim {

/// [v]: [v] u = v x u.
[[nodiscard]] inline linalg::Matrix3 cross_matrix(const linalg::Vector3& v) {
    linalg::Matrix3 m;
    m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
    return m;
}

}  // namespace pliant::sim
