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

/// sums (places, 9) += `weight` times what column `node` of the lower triangle, with half of its diagonal block, gives
/// to the coarse nodes: place[c] is where the sum of coarse node c goes. Blocks by columns. In double precision, since
/// where a body bends easily the blocks nearly cancel.
void add_column_to_corners(const LowerTriangle& matrix, int node, double weight, const Followers& followers,
                           const int* place, double* sums);

}  // namespace pliant::linalg
