// Which nodes of a rank are coupled, and where that goes in the matrix of all ranks.
#pragma once

#include <petscmat.h>

#include <functional>
#include <vector>

#include "base/linalg/sparse.hpp"
#include "simulation/distributed/balance.hpp"
#include "simulation/distributed/petsc.hpp"

namespace pliant::sim::distributed {

/// Over the nodes that a rank knows, held ones too. The pattern has the lower triangle; `places` are the rows of the
/// whole matrix, without nodes that are fixed.
struct KnownPattern {
    linalg::SymmetricPattern pattern;  ///< block 3
    BlockSums sums;                    ///< of the tets
    struct Place {
        int slot = 0;    ///< in the pattern
        int column = 0;  ///< known node
        bool transposed = false;
    };
    std::vector<int> row_start;  ///< (known nodes + 1)
    std::vector<Place> places;
};
[[nodiscard]] KnownPattern known_pattern(const Balance& balance);

/// A matrix of all ranks in blocks, into which `add` adds; it is called twice, first only to find out what room there
/// must be. Collective.
[[nodiscard]] Owned<Mat, MatDestroy> make_matrix(const Balance& balance, int block,
                                                 const std::function<void(Mat)>& add);

}  // namespace pliant::sim::distributed
