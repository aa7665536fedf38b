// The matrix of the corners of quadratic tets from that of all their nodes, in SIMD.
#pragma once

#include <array>

#include "base/linalg/lower_triangle.hpp"

namespace pliant::linalg {

/// How nodes follow coarse ones.
struct Followers {
    const std::array<int, 2>* ends;  ///< (nodes) as in Nesting

    /// How much of the motion of one of its coarse nodes a node makes.
    [[nodiscard]] double share(int node) const { return ends[node][0] == ends[node][1] ? 1.0 : 0.5; }
};

/// Sums over the nodes that follow a coarse one, for each coarse node from `first` on: of what their columns of the
/// matrix give to its followers, (places, 9), blocks by columns. place[c]: where those of coarse node c are.
struct CornerSums {
    int first;
    const int* place;
    double* below;     ///< of blocks from the diagonal down
    double* mirrored;  ///< of those above it, transposed
};

/// Adds column `node` of the matrix, times `weight`. In double precision, since where a body bends easily the blocks
/// nearly cancel.
void add_to_corners(const LowerTriangle& matrix, int node, double weight, const Followers& followers,
                    const CornerSums& sums);

}  // namespace pliant::linalg
