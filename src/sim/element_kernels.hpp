// Forces and stiffness of several tets at once, in SIMD, for the laws in the invariants of F.
#pragma once

#include "material/law.hpp"

namespace pliant::sim {

/// Tets that are worked on together; arrays hold this many numbers next to one another, one of each tet.
inline constexpr int batch_lanes = 8;

/// One batch of tets of one law. All arrays are aligned to 64 bytes.
struct TetBatch {
    int nodes_per_tet;
    int points;               ///< of integration
    const int* nodes;         ///< (nodes_per_tet, lanes)
    const double* gradients;  ///< (points, nodes_per_tet, 3, lanes) grad N_a, 1/m
    const double* volumes;    ///< (points, lanes) m^3; 0 in lanes that hold no tet
};

struct BatchResult {
    double energy_J = 0;
    double min_J =
        0;  ///< over all points; not positive where a tet is inside out or not finite: then nothing else is set
};

/// At node positions `x` (3n). Writes forces (nodes_per_tet, 3, lanes) unless null.
[[nodiscard]] BatchResult batch_forces(const TetBatch& batch, const material::InvariantForm& law, const double* x,
                                       double* forces);

/// Blocks of the stiffness of each pair of nodes a <= b, at b (b + 1) / 2 + a: (pairs, 9, lanes), each block by
/// columns; rows belong to a. Precondition: min_J > 0.
void batch_tangent(const TetBatch& batch, const material::InvariantForm& law, const double* x, double* blocks);

}  // namespace pliant::sim
