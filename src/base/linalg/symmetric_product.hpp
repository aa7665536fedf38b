// Products of symmetric matrices with blocks of 3 by 3, of which the lower triangle is stored, in SIMD.
#pragma once

#include <cstddef>

namespace pliant::linalg {

/// Where the blocks of consecutive columns of a lower triangle are: column j, at place place[start[j]], has the blocks
/// start[j] .. start[j + 1] in the rows at place[k], the diagonal first. Of a diagonal block the lower triangle is
/// used.
struct BlockColumns {
    std::size_t count;
    const int* start;  ///< (count + 1)
    const int* place;  ///< (blocks)
};

/// Numbers of which each is the sum of two: (blocks, 9), each block by columns, and one number that is read but not
/// used.
struct SplitBlocks {
    const float* value;
    const float* rest;
};

/// product (places, columns, 4) += matrix * v (places, columns, 4), for one column of v or two; the last number of four
/// is zero in v, and not used in the product. Both arrays are aligned to the size of a place. Two columns give the same
/// bits as each alone, and take little longer than one. `blocks` (blocks, 9): each by columns.
void add_symmetric_product(const BlockColumns& at, const double* blocks, const double* v, double* product);
void add_symmetric_product(const BlockColumns& at, const SplitBlocks& blocks, int columns, const double* v,
                           double* product);
/// The same in single precision; one number behind the blocks is read but not used.
void add_symmetric_product(const BlockColumns& at, const float* blocks, int columns, const float* v, float* product);

/// value + rest (count) <- numbers, to about 14 digits.
void split(const double* numbers, std::size_t count, float* value, float* rest);

}  // namespace pliant::linalg
