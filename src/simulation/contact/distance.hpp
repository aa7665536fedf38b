// Squared distances between a point and a triangle and between two edges, with exact derivatives.
//
// The nearest points are found by minimising |r|², r = Σ wᵢ(θ) xᵢ, over the parameters θ that are free once it is clear
// which parts are nearest (a corner: none; an edge: one; a face or two crossing edges: two). The weights are linear in
// θ, so the derivatives of D = min |r|² follow from the envelope theorem, the same few lines for every case:
//
//     ∂D/∂xᵢ = 2 wᵢ r      ∂²D/∂x² = 2 wwᵀ⊗I − M A⁻¹ Mᵀ,   Mᵢₖ = 2 (wᵢ rₖ + wᵢ,ₖ r),   Aₖₗ = 2 rₖ·rₗ,   rₖ = ∂r/∂θₖ
//
// Source of the cases: Li, Ferguson, Schneider et al. 2020, "Incremental Potential Contact", section 3 and appendix A.
#pragma once

#include <Eigen/Core>
#include <array>

#include "base/core/vec3.hpp"

namespace pliant::sim::contact {

using Vector12 = Eigen::Matrix<double, 12, 1>;   ///< four points, coordinates of one point together
using Matrix12 = Eigen::Matrix<double, 12, 12>;  ///< the same order

/// The points of a pair. Point-triangle: the point, then the corners. Edge-edge: the ends of one, then of the other.
using Stencil = std::array<Vec3, 4>;

/// Which convex combination of the two features is nearest.
struct Nearest {
    std::array<double, 4> weights{};                ///< r = Σ weights[i] x[i]; sum 0
    std::array<std::array<double, 4>, 2> slopes{};  ///< change of the weights with parameter k < free
    int free = 0;                                   ///< number of free parameters
};

[[nodiscard]] Nearest nearest_point_triangle(const Stencil& x);

/// Where the edges are parallel (sine below 1e-8) the nearest pair that has an end of one of them is taken.
[[nodiscard]] Nearest nearest_edges(const Stencil& x);

enum class Features { point_triangle, edge_edge };

[[nodiscard]] inline Nearest nearest(Features features, const Stencil& x) {
    return features == Features::point_triangle ? nearest_point_triangle(x) : nearest_edges(x);
}

/// A lower bound of the distance, m, several times cheaper than the distance itself: the gap projected onto the line
/// between the centres; 0 if there is no gap.
[[nodiscard]] double distance_bound(Features features, const Stencil& x);

/// The vector between the nearest points, from the second feature to the first, metres.
[[nodiscard]] inline Vec3 separation(const Nearest& n, const Stencil& x) {
    return n.weights[0] * x[0] + n.weights[1] * x[1] + n.weights[2] * x[2] + n.weights[3] * x[3];
}

/// D in m² and its derivatives. D has continuous first derivatives except where two edges are parallel; its second
/// derivatives jump where the nearest parts change.
[[nodiscard]] double squared_distance(const Nearest& n, const Stencil& x);
[[nodiscard]] Vector12 squared_distance_gradient(const Nearest& n, const Stencil& x);
[[nodiscard]] Matrix12 squared_distance_hessian(const Nearest& n, const Stencil& x);

/// |u × v|² of two edges, m⁴, and its derivatives: zero where they are parallel.
[[nodiscard]] double squared_cross(const Stencil& x);
[[nodiscard]] Vector12 squared_cross_gradient(const Stencil& x);
[[nodiscard]] Matrix12 squared_cross_hessian(const Stencil& x);

}  // namespace pliant::sim::contact
