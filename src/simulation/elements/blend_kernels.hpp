// Forces and stiffness of several shape-blend tets at once, in SIMD, like those of element_kernels.hpp.
#pragma once

#include "simulation/elements/element_kernels.hpp"

namespace pliant::sim {

/// As batch_forces. The energy is that for a = 1; otherwise the law has none, and it is 0.
[[nodiscard]] BatchResult batch_blend_forces(const TetBatch& batch, const material::ShapeBlend& law, const double* x,
                                             double* forces);

/// As batch_tangent: the symmetric part of the stiffness. Precondition: min_J > 0.
void batch_blend_tangent(const TetBatch& batch, const material::ShapeBlend& law, const double* x, double* blocks);

}  // namespace pliant::sim
