// The elastic body: integration points, forces, energy, tangent.
#pragma once

#include <span>
#include <vector>

#include "core/error.hpp"
#include "linalg/small.hpp"
#include "linalg/sparse.hpp"
#include "material/law.hpp"

namespace pliant::sim {

struct Description;

/// Isoparametric tets: 1 integration point for linear ones, 4 for quadratic ones (as CalculiX' C3D4 and C3D10).
/// F = sum_a x_a (grad N_a)^T, f_a = sum_q w_q P grad N_a. All results are the same bits on any number of threads.
class Elements {
public:
    /// An error names a tet that is flat or turned inside out at rest.
    [[nodiscard]] static Result<Elements> create(const Description& description);

    struct Evaluation {
        double energy_J = 0;  ///< of the laws that have one
        double min_J = 1;     ///< over all integration points; if it is not positive, nothing else is computed
    };
    /// Adds the internal forces (3n) at node positions `x` (3n). Without `forces` only energy and min_J are found.
    /// `laws` (materials), where given, stand in for the model's: targets of actuated space change with the program.
    Evaluation evaluate(std::span<const double> x, std::span<double> forces,
                        std::span<const material::Law> laws = {}) const;

    /// Adds the tangent stiffness to `values` of a pattern over free nodes (block 3). With `project`, every integration
    /// point contributes the nearest positive semi-definite matrix instead. Precondition: min_J > 0.
    void add_tangent(std::span<const double> x, const std::vector<int>& free_index,
                     const linalg::SymmetricPattern& pattern, std::span<double> values, bool project,
                     std::span<const material::Law> laws = {}) const;

    /// Adds the weighted Laplacian G^T W G (thesis A.4, A^T A, in the metric of the deformation gradient) for a pattern
    /// of block 1; W = stiffness_bound(law) times volume.
    void add_laplacian(const std::vector<int>& free_index, const linalg::SymmetricPattern& pattern,
                       std::span<double> values) const;
    /// result (3n) += Laplacian of u (3n).
    void apply_laplacian(std::span<const double> u, std::span<double> result) const;

    /// The consistent mass matrix M_ab = integral of density N_a N_b of straight tets: factor * M added to a pattern of
    /// block 3, and result (3n) += M u.
    void add_mass(const std::vector<int>& free_index, const linalg::SymmetricPattern& pattern, std::span<double> values,
                  double factor) const;
    void apply_mass(std::span<const double> u, std::span<double> result) const;

    /// Integral of density times N_a: what gravity multiplies, (n) kg.
    [[nodiscard]] const std::vector<double>& node_mass_kg() const { return node_mass_; }
    [[nodiscard]] bool has_energy() const { return has_energy_; }

    /// Deformation gradients at the integration points of tet t and their volumes.
    [[nodiscard]] int points_per_tet() const { return points_per_tet_; }
    [[nodiscard]] linalg::Matrix3 deformation_gradient(std::size_t tet, int point, std::span<const double> x) const;
    [[nodiscard]] double point_volume(std::size_t tet, int point) const {
        return volume_[tet * static_cast<std::size_t>(points_per_tet_) + static_cast<std::size_t>(point)];
    }
    [[nodiscard]] const material::Law& law(std::size_t tet) const { return laws_[static_cast<std::size_t>(law_[tet])]; }
    [[nodiscard]] std::size_t tet_count() const { return law_.size(); }

    /// Node lists of all tets, as free indices: the cliques of the stiffness pattern.
    [[nodiscard]] std::vector<std::vector<int>> cliques(const std::vector<int>& free_index) const;

private:
    Elements() = default;
    [[nodiscard]] const double* gradients(std::size_t tet, int point) const {
        return gradient_.data() + (tet * static_cast<std::size_t>(points_per_tet_) + static_cast<std::size_t>(point)) *
                                      3 * static_cast<std::size_t>(nodes_per_tet_);
    }
    Status integrate_tet(const Description& description, std::size_t tet);
    void link_nodes(std::size_t node_count);
    /// Upper triangle by blocks of 3, row by row, (3 nodes_per_tet)^2.
    void tet_tangent(std::size_t tet, std::span<const double> x, const material::Law& law, bool project,
                     double* K) const;
    Evaluation evaluate_tet(std::size_t tet, std::span<const double> x, const material::Law& law, double* forces) const;
    [[nodiscard]] const material::Law& law_among(std::span<const material::Law> laws, std::size_t tet) const {
        return laws.empty() ? law(tet) : laws[static_cast<std::size_t>(law_[tet])];
    }

    int nodes_per_tet_ = 4;
    int points_per_tet_ = 1;
    bool has_energy_ = true;
    std::vector<int> nodes_;        ///< (m * nodes_per_tet)
    std::vector<int> law_;          ///< (m)
    std::vector<double> gradient_;  ///< (m, points, nodes_per_tet, 3): grad N_a, 1/m
    std::vector<double> volume_;    ///< (m, points): integration weights, m^3
    std::vector<double> node_mass_;
    std::vector<double> tet_mass_;  ///< (m) kg
    std::vector<material::Law> laws_;
    // For each node the places in the per-tet force buffer that add up to its force, in the order of the tets.
    std::vector<int> use_start_;
    std::vector<int> use_;
};

}  // namespace pliant::sim
