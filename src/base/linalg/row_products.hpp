// Products of a matrix of 3 by 3 blocks that lies row by row, in SIMD.
#pragma once

#include <cstddef>

namespace pliant::linalg {

/// Blocks of 3 by 3, each by columns. Row i has the entries start[i] .. start[i + 1].
struct RowBlocks {
    const int* start;    ///< (rows + 1)
    const int* column;   ///< (entries)
    const float* value;  ///< (entries, 9), and one more that is read but does not count
    const float* rest;   ///< what `value` leaves out, alike
};

/// y (3 rows, columns) <- the rows from `begin` to `end` of the matrix times x (3 nodes, columns): of value + rest in
/// double precision, of value alone in single. One column or two, whose numbers lie side by side: two take little
/// longer than one. Precondition: two numbers after the end of x may be read.
void multiply_rows(const RowBlocks& matrix, std::size_t begin, std::size_t end, int columns, const double* x,
                   double* y);
void multiply_rows(const RowBlocks& matrix, std::size_t begin, std::size_t end, int columns, const float* x, float* y);

}  // namespace pliant::linalg
