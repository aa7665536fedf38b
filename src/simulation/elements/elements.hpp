// The elastic body: integration points, forces, energy, tangent.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/core/aligned_array.hpp"
#include "base/core/array_pool.hpp"
#include "base/core/error.hpp"
#include "base/linalg/small.hpp"
#include "base/linalg/sparse.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "robot/description/law.hpp"
#include "simulation/elements/block_sums.hpp"
#include "simulation/elements/element_kernels.hpp"
#include "simulation/elements/node_sums.hpp"

namespace pliant::material {
struct RestModuli;
}

namespace pliant::sim {

struct Description;

/// Isoparametric tets: 1 integration point for linear ones, 4 for quadratic ones (as CalculiX' C3D4 and C3D10).
/// F = sum_a x_a (grad N_a)^T, f_a = sum_q w_q P grad N_a. All results are the same bits on any number of threads.
class Elements {
public:
    /// Errors: a tet that is flat or inverted at rest; the message names it.
    [[nodiscard]] static Result<Elements> create(const Description& description);

    struct Evaluation {
        double energy_J = 0;  ///< of the laws that have an energy
        double min_J = 1;     ///< over all integration points; if it is not positive, nothing else is computed
    };
    /// Adds the internal forces (3n) at node positions `x` (3n). With empty `forces` only energy and min_J are
    /// computed.
    Evaluation evaluate(std::span<const double> x, std::span<double> forces) const;

    /// Maps the pairs of the tets' nodes to a pattern over free nodes: made once for each pattern.
    [[nodiscard]] BlockSums block_sums(const std::vector<int>& free_index,
                                       const linalg::SymmetricPattern& pattern) const;
    /// Adds the tangent stiffness to the `values` of the pattern of the sums, in blocks of 3. With `project`, every
    /// integration point contributes linalg::with_positive_eigenvalues() of its matrix. Precondition: min_J > 0.
    void add_tangent(std::span<const double> x, const BlockSums& sums, std::span<double> values, bool project) const;

    /// Adds Hooke's law with rest_moduli() for the changes of volume and Green-Lagrange strain that a motion u causes
    /// at `x`: w . K u = sum of volume times (lame (cof F : grad w) (cof F : grad u) + 2 shear a:e), e = sym(F^T grad
    /// u), a = sym(F^T grad w). It resists changes of shape, and no rotation of the body as it is at `x`. Positive
    /// semi-definite.
    void add_strain_stiffness(std::span<const double> x, const BlockSums& sums, std::span<double> values) const;

    /// Adds the skew part of the tangent, which add_tangent leaves out and only laws without an energy have, to a
    /// pattern of block 3; `index` (n) of each node in it, or -1. The blocks at and below the diagonal are set; those
    /// above are minus their transposes. Precondition: min_J > 0.
    void add_skew(std::span<const double> x, const std::vector<int>& index, const linalg::SymmetricPattern& pattern,
                  std::span<double> values) const;

    /// Adds the weighted Laplacian G^T W G (A^T A of thesis A.4, in the metric of the deformation gradient), one number
    /// for each pair of the pattern of the sums; W = stiffness_bound(law) times volume.
    void add_laplacian(const BlockSums& sums, std::span<double> values) const;
    /// result (3n) += Laplacian of u (3n).
    void apply_laplacian(std::span<const double> u, std::span<double> result) const;

    /// result (3n) += G^T W D with D = exp(M) F - F_end at each point: the second-order term of the rotation, which a
    /// straight step of the nodes lacks. W as in the Laplacian.
    void add_rotation_term(const RotatingStep& rotating, std::span<double> result) const;

    /// Rotation of each point from `before` to `now` (3n), for add_rotated. Precondition: min_J > 0 in both.
    void find_rotations(std::span<const double> before, std::span<const double> now,
                        AlignedArray<double>& rotations) const;
    enum class Direction { on, back };
    /// result (3n) += G^T W R G u, or with R^T: the Laplacian of u with its gradients rotated forwards or back.
    void add_rotated(const AlignedArray<double>& rotations, Direction direction, std::span<const double> u,
                     std::span<double> result) const;

    /// The consistent mass matrix of straight tets, M_ab = integral of density N_a N_b, with the masses of objects and
    /// point masses: factor * M added to a pattern of block 3, of which these are the sums, and result (3n) += M u.
    void add_mass(const BlockSums& sums, const std::vector<int>& free_index, const linalg::SymmetricPattern& pattern,
                  std::span<double> values, double factor) const;
    void apply_mass(std::span<const double> u, std::span<double> result) const;
    /// The same for the tets alone, with given masses (m).
    void apply_mass(std::span<const double> tet_mass, std::span<const double> u, std::span<double> result) const;
    /// (m) u . M v of each tet per kg of its mass.
    [[nodiscard]] std::vector<double> mass_products(std::span<const double> u, std::span<const double> v) const;

    /// (n) integral of density times N_a, kg: the nodal masses for gravity.
    [[nodiscard]] const std::vector<double>& node_mass_kg() const { return node_mass_; }
    /// The four nodes of each rigid object, with a quarter of its mass each.
    [[nodiscard]] const std::vector<std::array<int, 4>>& object_nodes() const { return object_nodes_; }
    [[nodiscard]] bool has_energy() const { return has_energy_; }

    /// Deformation gradients at the integration points of tet t and their volumes, times the weight of the tet.
    [[nodiscard]] int points_per_tet() const { return points_per_tet_; }
    [[nodiscard]] linalg::Matrix3 deformation_gradient(std::size_t tet, int point, std::span<const double> x) const;
    [[nodiscard]] double point_volume(std::size_t tet, int point) const {
        return volume_[place_[tet] / lanes * points() * lanes + static_cast<std::size_t>(point) * lanes +
                       place_[tet] % lanes];
    }
    [[nodiscard]] const material::Law& law(std::size_t tet) const { return laws_[static_cast<std::size_t>(law_[tet])]; }
    /// Index of the material of a tet.
    [[nodiscard]] int material(std::size_t tet) const { return law_[tet]; }
    [[nodiscard]] std::size_t tet_count() const { return law_.size(); }
    [[nodiscard]] std::size_t nodes_per_tet() const { return width(); }
    [[nodiscard]] int node_of(std::size_t tet, int a) const { return node(tet, a); }
    /// grad N_a at an integration point, 1/m.
    [[nodiscard]] Vec3 shape_gradient(std::size_t tet, int point, int a) const {
        const double* g = gradient(tet, point, a);
        return {g[0], g[lanes], g[2 * lanes]};
    }

    /// N_a at an integration point.
    [[nodiscard]] double shape_value(int point, int a) const {
        return shapes_[static_cast<std::size_t>(point)][static_cast<std::size_t>(a)];
    }

    /// Node lists of all tets and point masses, as free indices: the cliques of the stiffness pattern.
    [[nodiscard]] linalg::Lists cliques(const std::vector<int>& free_index) const;

private:
    static constexpr std::size_t lanes = batch_lanes;
    static constexpr std::size_t no_tet = static_cast<std::size_t>(-1);

    Elements() = default;
    [[nodiscard]] std::size_t width() const { return static_cast<std::size_t>(nodes_per_tet_); }
    [[nodiscard]] std::size_t points() const { return static_cast<std::size_t>(points_per_tet_); }
    [[nodiscard]] std::size_t pairs() const { return width() * (width() + 1) / 2; }
    [[nodiscard]] std::size_t batches() const { return batch_law_.size(); }
    [[nodiscard]] int node(std::size_t tet, int a) const {
        return nodes_[(place_[tet] / lanes * width() + static_cast<std::size_t>(a)) * lanes + place_[tet] % lanes];
    }
    /// First component of grad N_a; the others follow at steps of `lanes`.
    [[nodiscard]] const double* gradient(std::size_t tet, int point, int a) const {
        return gradient_.data() +
               ((place_[tet] / lanes * points() + static_cast<std::size_t>(point)) * width() +
                static_cast<std::size_t>(a)) *
                   3 * lanes +
               place_[tet] % lanes;
    }
    [[nodiscard]] TetBatch batch(std::size_t b) const;
    void group_by_law(const mesh::TetMesh& mesh);
    void fill_empty_lanes();
    Status integrate(const Description& description);
    void weigh(const Description& description);
    void add_lumps(const Description& description);
    [[nodiscard]] const material::Law& law_of_batch(std::size_t batch) const {
        return laws_[static_cast<std::size_t>(batch_law_[batch])];
    }
    // Of batches, where the law has no SIMD kernel; same arrays as those of element_kernels.hpp.
    [[nodiscard]] BatchResult forces_one_by_one(std::size_t batch, std::span<const double> x, const material::Law& law,
                                                double* forces) const;
    void tangent_one_by_one(std::size_t batch, std::span<const double> x, const material::Law& law, bool project,
                            double* blocks) const;
    void strain_one_by_one(std::size_t batch, std::span<const double> x, const material::RestModuli& moduli,
                           double* blocks) const;
    /// Masses of the tets of a batch, kg; 0 in empty lanes.
    struct LaneMasses {
        alignas(64) double values[lanes] = {};
    };
    [[nodiscard]] LaneMasses lane_masses(std::size_t batch, std::span<const double> tet_mass) const;
    template <class ForcesOf>
    void add_batches(std::span<double> result, const ForcesOf& forces_of) const;

    int nodes_per_tet_ = 4;
    int points_per_tet_ = 1;
    bool has_energy_ = true;
    std::vector<int> law_;                     ///< (m)
    std::vector<std::size_t> place_;           ///< (m) batch * lanes + lane: each batch holds tets of one law
    std::vector<std::size_t> tet_;             ///< (batches, lanes) the inverse; no_tet where a lane is empty
    std::vector<int> batch_law_;               ///< (batches)
    AlignedArray<int> nodes_;                  ///< (batches, nodes_per_tet, lanes)
    AlignedArray<double> gradient_;            ///< (batches, points, nodes_per_tet, 3, lanes): grad N_a, 1/m
    AlignedArray<double> volume_;              ///< (batches, points, lanes): integration weights, m^3
    std::vector<std::vector<double>> shapes_;  ///< (points, nodes_per_tet) N_a
    std::vector<double> node_mass_;
    std::vector<double> tet_mass_;  ///< (m) kg
    /// A point mass that moves with the weighted mean of nodes: mass w w^T.
    struct Lump {
        std::vector<int> nodes;
        std::vector<double> weights;
        double mass_kg = 0;
    };
    std::vector<Lump> lumps_;
    std::vector<std::array<int, 4>> object_nodes_;
    std::vector<material::Law> laws_;
    NodeSums sums_;
    mutable ArrayPool<double> scratch_;  ///< partial sums of pieces and runs
};

}  // namespace pliant::sim
