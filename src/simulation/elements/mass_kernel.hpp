// The consistent mass of several tets at once, in SIMD.
#pragma once

#include "simulation/elements/element_kernels.hpp"

namespace pliant::sim {

/// Writes momenta (nodes_per_tet, 3, lanes) for velocities `v` (3n): of node a, the mass of its tet (lanes) times the
/// sum of shares_ab v_b; `shares` (nodes_per_tet, nodes_per_tet).
void batch_momentum(const TetBatch& batch, const double* masses, const double* shares, const double* v,
                    double* momenta);

}  // namespace pliant::sim
