// How large a factor will be.
#pragma once

#include "base/linalg/sparse.hpp"

namespace pliant::linalg {

/// Of a factorisation with one unknown per node.
struct FactorSize {
    double entries = 0;  ///< a measure of memory
    double work = 0;     ///< multiply-adds: a measure of time
};

/// Estimated from an analysis of groups of neighbouring nodes, in a tenth of the time that an analysis of all nodes
/// takes; usually within a factor of 1.5. The separators that divide a body are surfaces: where a group has g nodes,
/// they have g^(2/3) times as many nodes as groups, so the entries grow with g^(4/3) and the work with g^2.
[[nodiscard]] FactorSize estimate_factor_size(const SymmetricPattern& pattern);

}  // namespace pliant::linalg
