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

/// The same, but the stiffness of each point is replaced by the nearest positive semi-definite one.
void batch_projected_tangent(const TetBatch& batch, const material::InvariantForm& law, const double* x,
                             double* blocks);

/// A motion in which every tet turns by a rate M instead of growing: from F at `now` to exp(M) F. `end` is where the
/// nodes would be without that. All positions (3n).
struct Turning {
    const double* now;
    const double* end;
    /// Null: M F is the gradient of the motion from `now` to `end`. Else M = onward L1 + earlier L0 with the rates L1
    /// from `before` to `now` and L0 from `first` to `before` (L1 where `first` is null): F_now = exp(L1) F_before.
    const double* before = nullptr;
    const double* first = nullptr;
    double onward = 1;
    double earlier = 0;
};

/// Writes forces (nodes_per_tet, 3, lanes): sum over the points of stiffness * volume * (exp(M) F - F_end) grad N_a.
/// Preconditions: F is regular at `now` and, where given, at `before`.
void batch_turning(const TetBatch& batch, const Turning& turning, double stiffness, double* forces);

}  // namespace pliant::sim
