// Products of a stiffness matrix with the motions of one group of nodes, in SIMD.
#pragma once

#include <cstddef>
#include <span>

#include "base/linalg/lower_triangle.hpp"

namespace pliant::linalg {

/// The motions of groups, six each, by rows of nodes: entry e of node i, start[i] <= e < start[i + 1], holds how the
/// motions of a group move the node.
struct GroupMotions {
    static constexpr std::size_t modes = 6;
    const int* start;     ///< (nodes + 1)
    const int* group;     ///< (entries)
    const float* motion;  ///< (entries, 18): 3 by 6, by columns
};

/// Where a group appears among the motions of all.
struct MotionUse {
    int node, entry;
};

/// A row of six numbers, followed by two that are zero.
inline constexpr std::size_t modes_stored = 8;

/// forces (places, 3, modes_stored) += A times the motions of a group: place[j] is where the force on node j goes.
/// Accumulated in double precision: where a body bends easily, the forces on a node nearly cancel. Precondition:
/// `place` has one for each node that is coupled to a node of `uses`.
void add_forces_of_group(const LowerTriangle& matrix, const GroupMotions& motions, std::span<const MotionUse> uses,
                         const int* place, double* forces);

/// sums (places, 6, modes_stored) += (motions of group h)^T forces, for each group h >= `first` that moves one of the
/// nodes: place[h] is where its sum goes. forces (nodes.size(), 3, modes_stored).
void add_products_with_groups(const GroupMotions& motions, std::span<const int> nodes, const double* forces, int first,
                              const int* place, double* sums);

}  // namespace pliant::linalg
