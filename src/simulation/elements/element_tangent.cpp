// Tangent stiffness of the elastic body: blocks of the tets, and where they go.
#include <Eigen/Dense>
#include <algorithm>
#include <array>

#include "base/core/parallel.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/elements/blend_kernels.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/material/point.hpp"
#include "simulation/material/response.hpp"
#include "simulation/material/rest_moduli.hpp"

namespace pliant::sim {
namespace {

using linalg::Matrix3;
using linalg::Matrix9;
using linalg::Vector3;

constexpr std::size_t places_per_piece = 1024;

}  // namespace

BlockSums Elements::block_sums(const std::vector<int>& free_index, const linalg::SymmetricPattern& pattern) const {
    std::vector<int> slots(batches() * pairs() * lanes, BlockSums::no_slot);
    parallel_for(tet_.size(), places_per_piece, [&](std::size_t begin, std::size_t end) {
        for (std::size_t place = begin; place < end; ++place) {
            if (tet_[place] == no_tet) continue;
            std::array<int, 10> free{};
            for (std::size_t a = 0; a < width(); ++a)
                free[a] = free_index[nodes_[(place / lanes * width() + a) * lanes + place % lanes]];
            int* slot = slots.data() + place / lanes * pairs() * lanes + place % lanes;
            for (std::size_t b = 0; b < width(); ++b) {
                for (std::size_t a = 0; a <= b; ++a, slot += lanes) {
                    const auto [j, i] = std::minmax(free[a], free[b]);
                    if (j >= 0) *slot = 2 * pattern.find(i, j) + (free[a] < free[b] ? 1 : 0);
                }
            }
        }
    });
    return {std::move(slots), batches(), pattern.node_row.size()};
}

void Elements::tangent_one_by_one(std::size_t batch, std::span<const double> x, const material::Law& law, bool project,
                                  double* blocks) const {
    std::fill_n(blocks, pairs() * 9 * lanes, 0.0);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::size_t tet = tet_[batch * lanes + lane];
        for (int q = 0; tet != no_tet && q < points_per_tet_; ++q) {
            Matrix9 H = material::tangent(law, deformation_gradient(tet, q, x));
            H = project ? linalg::with_positive_eigenvalues(H) : Matrix9(0.5 * (H + H.transpose()));
            H *= point_volume(tet, q);
            double* block = blocks + lane;
            for (int b = 0; b < nodes_per_tet_; ++b) {
                const double* gb = gradient(tet, q, b);
                Eigen::Matrix<double, 9, 3> change = gb[0] * H.leftCols<3>();  // of P, for a motion of b
                for (int l = 1; l < 3; ++l) change += gb[static_cast<std::size_t>(l) * lanes] * H.middleCols<3>(3 * l);
                for (int a = 0; a <= b; ++a, block += 9 * lanes) {
                    const double* ga = gradient(tet, q, a);
                    Matrix3 K = ga[0] * change.topRows<3>();
                    for (int l = 1; l < 3; ++l)
                        K += ga[static_cast<std::size_t>(l) * lanes] * change.middleRows<3>(3 * l);
                    for (std::size_t k = 0; k < 9; ++k) block[k * lanes] += K.data()[k];
                }
            }
        }
    }
}

void Elements::add_tangent(std::span<const double> x, const BlockSums& sums, std::span<double> values,
                           bool project) const {
    const auto fill = [&](std::size_t b, double* blocks) {
        const material::Law& law = law_of_batch(b);
        const auto form = material::invariant_form(law);
        const auto* blend = std::get_if<material::ShapeBlend>(&law);
        if (form && project)
            batch_projected_tangent(batch(b), *form, x.data(), blocks);
        else if (form)
            batch_tangent(batch(b), *form, x.data(), blocks);
        else if (blend != nullptr && !project)
            batch_blend_tangent(batch(b), *blend, x.data(), blocks);
        else
            tangent_one_by_one(b, x, law, project, blocks);
    };
    sums.add(fill, 9, values, scratch_);
}

void Elements::strain_one_by_one(std::size_t batch, std::span<const double> x, const material::RestModuli& moduli,
                                 double* blocks) const {
    std::fill_n(blocks, pairs() * 9 * lanes, 0.0);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::size_t tet = tet_[batch * lanes + lane];
        for (int q = 0; tet != no_tet && q < points_per_tet_; ++q) {
            const Matrix3 F = deformation_gradient(tet, q, x), cofactor = material::cofactor(F);
            const Matrix3 stretch = F * F.transpose();
            const double volume = point_volume(tet, q), lame = volume * moduli.lame_Pa,
                         shear = volume * moduli.shear_Pa;
            std::array<Vector3, 10> rest, now, normal;
            for (std::size_t a = 0; a < width(); ++a) {
                rest[a] = linalg::vector(shape_gradient(tet, q, static_cast<int>(a)));
                now[a] = F * rest[a];
                normal[a] = cofactor * rest[a];
            }
            double* block = blocks + lane;
            for (std::size_t b = 0; b < width(); ++b) {
                for (std::size_t a = 0; a <= b; ++a, block += 9 * lanes) {
                    const Matrix3 K = lame * normal[a] * normal[b].transpose() + shear * now[b] * now[a].transpose() +
                                      shear * rest[a].dot(rest[b]) * stretch;
                    for (std::size_t k = 0; k < 9; ++k) block[k * lanes] += K.data()[k];
                }
            }
        }
    }
}

void Elements::add_strain_stiffness(std::span<const double> x, const BlockSums& sums, std::span<double> values) const {
    std::vector<material::RestModuli> moduli;
    for (const material::Law& law : laws_) moduli.push_back(material::rest_moduli(law));
    const auto fill = [&](std::size_t b, double* blocks) {
        strain_one_by_one(b, x, moduli[static_cast<std::size_t>(batch_law_[b])], blocks);
    };
    sums.add(fill, 9, values, scratch_);
}

void Elements::add_skew(std::span<const double> x, const std::vector<int>& index,
                        const linalg::SymmetricPattern& pattern, std::span<double> values) const {
    if (has_energy_) return;
    for (std::size_t t = 0; t < tet_count(); ++t) {
        if (material::has_energy(law(t))) continue;
        for (int q = 0; q < points_per_tet_; ++q) {
            const Matrix9 H = material::tangent(law(t), deformation_gradient(t, q, x));
            const Matrix9 skew = 0.5 * point_volume(t, q) * (H - H.transpose());
            for (int b = 0; b < nodes_per_tet_; ++b) {
                const int j = index[node(t, b)];
                if (j < 0) continue;
                const Vec3 gb = shape_gradient(t, q, b);
                Eigen::Matrix<double, 9, 3> change = gb.x * skew.leftCols<3>();
                change += gb.y * skew.middleCols<3>(3) + gb.z * skew.rightCols<3>();
                for (int a = 0; a < nodes_per_tet_; ++a) {
                    const int i = index[node(t, a)];
                    if (i < j) continue;
                    const Vec3 ga = shape_gradient(t, q, a);
                    Matrix3 K = ga.x * change.topRows<3>();
                    K += ga.y * change.middleRows<3>(3) + ga.z * change.bottomRows<3>();
                    pattern.add_block(values, i, j, [&](int r, int c) { return K(r, c); });
                }
            }
        }
    }
}

}  // namespace pliant::sim
