// Products with a matrix of 3 by 3 blocks stored by rows, in SIMD.
#pragma once

#include <cstddef>

namespace pliant::linalg {

/// Blocks of 3 by 3, each by columns. Row i has the entries start[i] .. start[i + 1].
struct RowBlocks {
    const int* start;    ///< (rows + 1)
    const int* column;   ///< (entries)
    const float* value;  ///< (entries, 9), plus one readable number at the end that is not used
    const float* rest;   ///< the rounding error of `value`, in the same layout
};

/// y (3 rows, columns) <- rows `begin` to `end` of the matrix times x (3 nodes, columns): with value + rest in double
/// precision, with value alone in single. One column, or two interleaved ones, which take little longer than one.
/// Precondition: two numbers past the end of x are readable.
void multiply_rows(const RowBlocks& matrix, std::size_t begin, std::size_t end, int columns, const double* x,
                   double* y);
void multiply_rows(const RowBlocks& matrix, std::size_t begin, std::size_t end, int columns, const float* x, float* y);

}  // namespace pliant::linalg
