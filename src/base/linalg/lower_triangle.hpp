// A symmetric matrix of 3 by 3 blocks by its lower triangle, as kernels see it.
#pragma once

namespace pliant::linalg {

/// Pair k of column j, start[j] <= k < start[j + 1], is the block A(row[k], j), by columns, the diagonal first and the
/// others by ascending rows. Row i has further blocks left of the diagonal: A(i, left_column[e]) is pair left_pair[e],
/// left_start[i] <= e < left_start[i + 1]. Valid as long as the matrix is.
struct LowerTriangle {
    const int* start;        ///< (nodes + 1)
    const int* row;          ///< (pairs)
    const int* left_start;   ///< (nodes + 1)
    const int* left_column;  ///< (pairs below the diagonal)
    const int* left_pair;    ///< (pairs below the diagonal)
    const float* value;      ///< (pairs, 9), and one number that is read but not used
    const float* rest;       ///< the rounding errors of `value`, in the same layout
};

}  // namespace pliant::linalg
