// A rigid body in affine coordinates: four nodes carry it, x = A X + p, and a stiff energy keeps A a rotation.
//
//     E = k/4 ‖AᵀA − 1‖²        A = Σ xₐ gₐᵀ
//
// Lan, Kaufman, Li, Jiang and Yang 2022, "Affine Body Dynamics". The motion of every point is linear in the nodes, so
// that a straight step of the nodes is a straight step of the surface.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "base/linalg/lists.hpp"
#include "base/linalg/small.hpp"
#include "base/linalg/sparse.hpp"

namespace pliant::sim {

class AffineBody {
public:
    /// `nodes`: not coplanar at `rest` (3n). `stiffness_J`: k, some hundred times the stiffness of soft bodies of its
    /// size.
    AffineBody(std::array<int, 4> nodes, double stiffness_J, std::span<const double> rest);

    /// J. Positions x (3n) metres.
    [[nodiscard]] double energy(std::span<const double> x) const;
    /// forces (3n) += gradient of the energy.
    void add_gradient(std::span<const double> x, std::span<double> forces) const;
    /// For a pattern (block 3) that holds all pairs of its nodes; `index` (n) of each node in it, or -1. `project`: the
    /// nearest matrix without negative eigenvalues.
    void add_hessian(std::span<const double> x, const std::vector<int>& index, const linalg::SymmetricPattern& pattern,
                     std::span<double> values, bool project) const;
    void append_clique(const std::vector<int>& index, linalg::Lists& cliques) const;
    /// As add_hessian(), for springs of `stiffness_N_m` between each node and the mean of the nodes: they resist a
    /// rotation and a stretch, and no translation.
    void add_hold(double stiffness_N_m, const std::vector<int>& index, const linalg::SymmetricPattern& pattern,
                  std::span<double> values) const;
    /// Root of the mean squared distance of the nodes from their mean, m.
    [[nodiscard]] double size(std::span<const double> x) const;

    // An energy-conserving step from `start` (3n) to x: with G = AᵀA − 1, Δ = A − A_start and the mean stress
    // S = k (G + G_start) / 2, the gradient (A + A_start)/2 · S does the work E(x) − E(start) along Δ, and a rotation
    // does not stretch the body, unlike the mean of the gradients along a straight path (Simo and Tarnow 1992, "The
    // discrete energy-momentum method"). For a minimum S is held fixed at `stress`, that of a state nearby, in
    //     k/8 ‖G + G_start‖² − ¼ ⟨Δ, Δ S⟩

    /// S, J.
    [[nodiscard]] linalg::Matrix3 mean_stress(std::span<const double> start, std::span<const double> x) const;
    /// As energy(), add_gradient() and add_hessian(), for such a step.
    [[nodiscard]] double mean_energy(std::span<const double> start, std::span<const double> x,
                                     const linalg::Matrix3& stress) const;
    void add_mean_gradient(std::span<const double> start, std::span<const double> x, const linalg::Matrix3& stress,
                           std::span<double> forces) const;
    void add_mean_hessian(std::span<const double> start, std::span<const double> x, const linalg::Matrix3& stress,
                          const std::vector<int>& index, const linalg::SymmetricPattern& pattern,
                          std::span<double> values, bool project) const;

    /// forces (3n) += change of the gradient with a motion (3n) of the rest positions: k scales with the volume, and
    /// the surface moves along, so that the weights of its points are unchanged.
    void add_rest_product(std::span<const double> x, std::span<const double> motion, std::span<double> forces) const;
    /// result (3n) += the transpose of that product with `weights` (3n) of the forces.
    void add_rest_weights(std::span<const double> x, std::span<const double> weights, std::span<double> result) const;

    /// A; its determinant is 1, apart from compression by contact.
    [[nodiscard]] linalg::Matrix3 deformation(std::span<const double> x) const;
    /// Position of the centre of mass, m.
    [[nodiscard]] linalg::Vector3 centre(std::span<const double> x) const;
    /// (4) weights of the nodes for the point at `rest_point` at rest, metres; sum 1.
    [[nodiscard]] std::array<double, 4> shares(const linalg::Vector3& rest_point) const;

    /// Derivatives of the weights with respect to the point, 1/m.
    [[nodiscard]] const std::array<linalg::Vector3, 4>& share_slopes() const { return gradients_; }

    [[nodiscard]] const std::array<int, 4>& nodes() const { return nodes_; }
    /// Approximate stiffness of one node against a stretch of the body, N/m.
    [[nodiscard]] double node_stiffness() const;

private:
    /// dE/dA, J, and its derivative with respect to A.
    [[nodiscard]] linalg::Matrix3 stress(const linalg::Matrix3& A) const;
    [[nodiscard]] linalg::Matrix3 stress_change(const linalg::Matrix3& A, const linalg::Matrix3& dA) const;
    /// The blocks of the nodes for the derivative of the stress: change(dA) for a change of A.
    void add_blocks(const std::function<linalg::Matrix3(const linalg::Matrix3&)>& change, const std::vector<int>& index,
                    const linalg::SymmetricPattern& pattern, std::span<double> values, bool project) const;
    void add(const linalg::Matrix3& per_gradient, std::span<double> forces) const;

    std::array<int, 4> nodes_;
    double stiffness_;
    std::array<linalg::Vector3, 4> gradients_;  ///< gₐ, 1/m
    linalg::Vector3 centre_;                    ///< at rest
};

}  // namespace pliant::sim
