// Forces and stiffness of several tets at once, in SIMD, for laws in the invariants of F.
#pragma once

#include <array>
#include <cstddef>

#include "robot/description/law.hpp"

namespace pliant::sim {

/// Number of tets in a batch; arrays hold this many adjacent numbers, one of each tet.
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

/// Stiffness block of each pair of nodes a <= b, at b (b + 1) / 2 + a: (pairs, 9, lanes), each block by columns; rows
/// belong to a. Precondition: min_J > 0.
void batch_tangent(const TetBatch& batch, const material::InvariantForm& law, const double* x, double* blocks);

/// The same, with linalg::with_positive_eigenvalues() of the stiffness of each integration point.
void batch_projected_tangent(const TetBatch& batch, const material::InvariantForm& law, const double* x,
                             double* blocks);

/// A step that applies rotations exactly: from F at `now` to exp(M) F, where M is the rate of deformation of the step.
/// `end` holds the node positions after the straight step. All positions (3n).
struct RotatingStep {
    static constexpr std::size_t most_past = 3;

    const double* now;
    const double* end;
    /// Previous states, the latest first, terminated by null. Empty: M F is the gradient of the motion from `now` to
    /// `end`. Else M = sum of weights[k] L_k with the rate L_k from past[k] to the state after it, F_after = exp(L_k)
    /// F.
    std::array<const double*, most_past> past{};
    std::array<double, most_past> weights{};
};

/// Writes forces (nodes_per_tet, 3, lanes): sum over the points of stiffness * volume * (exp(M) F - F_end) grad N_a.
/// Precondition: F is regular at `now` and at all states of the past but the first.
void batch_rotation_term(const TetBatch& batch, const RotatingStep& rotating, double stiffness, double* forces);

/// Rotation of each point between two states: the rotation nearest to F_now F_before^-1, (points, 9, lanes), by
/// columns. Precondition: det F > 0 in both.
void batch_rotations(const TetBatch& batch, const double* before, const double* now, double* rotations);

/// Writes forces (nodes_per_tet, 3, lanes): sum over the points of stiffness * volume * R grad u grad N_a, with the
/// rotations R or, with `back`, their transposes. `u` (3n).
void batch_rotated(const TetBatch& batch, const double* rotations, bool back, const double* u, double stiffness,
                   double* forces);

}  // namespace pliant::sim
