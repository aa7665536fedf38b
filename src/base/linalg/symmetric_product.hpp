// Products of a symmetric matrix with blocks of 3 by 3, of which the lower triangle is stored, in SIMD.
#pragma once

#include "base/linalg/sparse.hpp"

namespace pliant::linalg {

/// product (nodes, 4) += matrix * v (nodes, 4); the last number of each node of v is zero, that of the product is not
/// used. `values` as SymmetricPattern says. Both arrays are aligned to 32 bytes. Precondition: pattern.block is 3.
void add_symmetric_product(const SymmetricPattern& pattern, const double* values, const double* v, double* product);

}  // namespace pliant::linalg
