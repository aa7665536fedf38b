// Which local nodes of a rank are coupled, and their entries in the matrix of all ranks.
#pragma once

#include <petscmat.h>

#include <functional>
#include <vector>

#include "base/linalg/sparse.hpp"
#include "simulation/distributed/distributed_equilibrium.hpp"
#include "simulation/distributed/petsc.hpp"

namespace pliant::sim::distributed {

/// Over the local nodes, including held ones. The pattern has the lower triangle; `places` has whole rows of the
/// matrix, without fixed nodes.
struct LocalPattern {
    linalg::SymmetricPattern pattern;  ///< block 3
    BlockSums sums;                    ///< of the tets
    struct Place {
        int slot = 0;    ///< in the pattern
        int column = 0;  ///< local node
        bool transposed = false;
    };
    std::vector<int> row_start;  ///< (local nodes + 1)
    std::vector<Place> places;
};
[[nodiscard]] LocalPattern local_pattern(const DistributedEquilibrium& system);

/// A matrix of all ranks in blocks, filled by `add`, which is called twice: first only to count the entries.
/// Collective.
[[nodiscard]] Owned<Mat, MatDestroy> make_matrix(const DistributedEquilibrium& system, int block,
                                                 const std::function<void(Mat)>& add);

}  // namespace pliant::sim::distributed
