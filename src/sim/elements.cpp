#include "sim/elements.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.hpp"
#include "sim/model.hpp"

namespace pliant::sim {
namespace {

using linalg::Matrix3;
using linalg::Matrix9;
using linalg::Vector3;

constexpr std::size_t tets_per_piece = 256;
constexpr std::size_t max_tet_unknowns = 30;
constexpr double gauss_a = 0.58541019662496845446;  // (5 + 3 sqrt 5) / 20
constexpr double gauss_b = 0.13819660112501051518;  // (5 - sqrt 5) / 20

using Barycentric = std::array<double, 4>;

std::vector<Barycentric> integration_points(int order) {
    if (order == 1) return {{0.25, 0.25, 0.25, 0.25}};
    std::vector<Barycentric> points(4, {gauss_b, gauss_b, gauss_b, gauss_b});
    for (std::size_t i = 0; i < 4; ++i) points[i][i] = gauss_a;
    return points;
}

/// d N_a / d b_k for the barycentric coordinates b, (nodes, 4).
Eigen::Matrix<double, Eigen::Dynamic, 4> shape_gradients(int order, const Barycentric& b) {
    Eigen::Matrix<double, Eigen::Dynamic, 4> gradients(order == 1 ? 4 : 10, 4);
    gradients.setZero();
    for (int i = 0; i < 4; ++i) gradients(i, i) = order == 1 ? 1 : 4 * b[i] - 1;
    if (order == 1) return gradients;
    for (int e = 0; e < 6; ++e) {
        const auto& [p, q] = mesh::edge_corners[static_cast<std::size_t>(e)];
        gradients(4 + e, p) = 4 * b[q];
        gradients(4 + e, q) = 4 * b[p];
    }
    return gradients;
}

/// Integral of N_a N_b over a straight tet, as a share of its volume (Zienkiewicz and Taylor, The Finite Element
/// Method).
Eigen::MatrixXd mass_shares(int nodes) {
    if (nodes == 4) return (Eigen::MatrixXd::Ones(4, 4) + Eigen::MatrixXd::Identity(4, 4)) / 20;
    Eigen::MatrixXd shares(10, 10);
    shares.topLeftCorner(4, 4) = Eigen::MatrixXd::Ones(4, 4) + 5 * Eigen::MatrixXd::Identity(4, 4);
    for (int e = 0; e < 6; ++e) {
        const auto& [p, q] = mesh::edge_corners[static_cast<std::size_t>(e)];
        for (int corner = 0; corner < 4; ++corner)
            shares(4 + e, corner) = shares(corner, 4 + e) = corner == p || corner == q ? -4 : -6;
        for (int f = 0; f < 6; ++f) {
            const auto& [r, s] = mesh::edge_corners[static_cast<std::size_t>(f)];
            const bool shared = p == r || p == s || q == r || q == s;
            shares(4 + e, 4 + f) = e == f ? 32 : (shared ? 16 : 8);
        }
    }
    return shares / 420;
}

}  // namespace

Result<Elements> Elements::create(const Description& description) {
    const mesh::TetMesh& mesh = description.mesh;
    Elements elements;
    elements.nodes_per_tet_ = mesh.nodes_per_tet();
    elements.points_per_tet_ = mesh.order == 1 ? 1 : 4;
    elements.nodes_ = mesh.nodes;
    elements.node_mass_.assign(mesh.points.size(), 0.0);
    for (const Material& material : description.materials) {
        elements.laws_.push_back(material.law);
        elements.has_energy_ = elements.has_energy_ && material::has_energy(material.law);
    }
    for (const int region : mesh.region) elements.law_.push_back(description.material_of_region[region]);
    elements.gradient_.reserve(mesh.tet_count() * elements.points_per_tet_ * elements.nodes_per_tet_ * 3);
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        if (Status status = elements.integrate_tet(description, t); !status) return tl::unexpected(status.error());
    }
    elements.link_nodes(mesh.points.size());
    return elements;
}

Status Elements::integrate_tet(const Description& description, std::size_t tet) {
    const mesh::TetMesh& mesh = description.mesh;
    const auto nodes = mesh.tet(tet);
    const double density = description.materials[law_[tet]].density_kg_m3;
    const auto points = integration_points(mesh.order);
    tet_mass_.push_back(0);
    for (const Barycentric& b : points) {
        const auto dN = shape_gradients(mesh.order, b);
        Eigen::Matrix<double, 3, 4> dX = Eigen::Matrix<double, 3, 4>::Zero();
        for (int a = 0; a < nodes_per_tet_; ++a) {
            const Vec3& X = mesh.points[nodes[a]];
            dX += Vector3(X.x, X.y, X.z) * dN.row(a);
        }
        Matrix3 jacobian;  // d X / d (b1, b2, b3) with b0 = 1 - b1 - b2 - b3
        for (int k = 0; k < 3; ++k) jacobian.col(k) = dX.col(k + 1) - dX.col(0);
        const double determinant = jacobian.determinant();
        if (!(determinant > 0)) {
            return input_error("tetrahedron {} of the mesh is flat or inside out at rest (volume {:.3g} m^3)", tet,
                               determinant / 6);
        }
        const Matrix3 inverse = jacobian.inverse();
        for (int a = 0; a < nodes_per_tet_; ++a) {
            Vector3 local;
            for (int k = 0; k < 3; ++k) local[k] = dN(a, k + 1) - dN(a, 0);
            const Vector3 gradient = inverse.transpose() * local;
            gradient_.insert(gradient_.end(), {gradient[0], gradient[1], gradient[2]});
        }
        volume_.push_back(determinant / 6 / static_cast<double>(points.size()));
        tet_mass_.back() += density * volume_.back();
        const auto N = mesh::shape_functions(mesh.order, b);
        for (int a = 0; a < nodes_per_tet_; ++a) node_mass_[nodes[a]] += density * volume_.back() * N[a];
    }
    return {};
}

void Elements::link_nodes(std::size_t node_count) {
    use_start_.assign(node_count + 1, 0);
    for (const int node : nodes_) ++use_start_[node + 1];
    for (std::size_t i = 0; i < node_count; ++i) use_start_[i + 1] += use_start_[i];
    use_.resize(nodes_.size());
    std::vector<int> next(use_start_.begin(), use_start_.end() - 1);
    for (std::size_t k = 0; k < nodes_.size(); ++k) use_[next[nodes_[k]]++] = static_cast<int>(k);
}

Matrix3 Elements::deformation_gradient(std::size_t tet, int point, std::span<const double> x) const {
    const double* g = gradients(tet, point);
    const int* nodes = nodes_.data() + tet * static_cast<std::size_t>(nodes_per_tet_);
    Matrix3 F = Matrix3::Zero();
    for (int a = 0; a < nodes_per_tet_; ++a) {
        const double* xa = x.data() + 3 * static_cast<std::size_t>(nodes[a]);
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i < 3; ++i) F(i, j) += xa[i] * g[3 * a + j];
        }
    }
    return F;
}

Elements::Evaluation Elements::evaluate_tet(std::size_t tet, std::span<const double> x, const material::Law& law,
                                            double* forces) const {
    Evaluation result;
    result.min_J = std::numeric_limits<double>::infinity();
    for (int q = 0; q < points_per_tet_; ++q) {
        const Matrix3 F = deformation_gradient(tet, q, x);
        const double J = F.determinant();
        // A NaN must count as inverted: the comparison is written so that it does.
        result.min_J = J > 0 ? std::min(result.min_J, J) : (J <= 0 ? std::min(result.min_J, J) : -1);
        if (!(result.min_J > 0)) return result;
        const double volume = point_volume(tet, q);
        if (const auto density = material::energy(law, F)) result.energy_J += volume * *density;
        if (forces == nullptr) continue;
        const Matrix3 P = volume * material::stress(law, F);
        const double* g = gradients(tet, q);
        for (int a = 0; a < nodes_per_tet_; ++a) {
            for (int i = 0; i < 3; ++i) {
                forces[3 * a + i] += P(i, 0) * g[3 * a] + P(i, 1) * g[3 * a + 1] + P(i, 2) * g[3 * a + 2];
            }
        }
    }
    return result;
}

Elements::Evaluation Elements::evaluate(std::span<const double> x, std::span<double> forces,
                                        std::span<const material::Law> laws) const {
    const std::size_t pieces = (tet_count() + tets_per_piece - 1) / tets_per_piece;
    std::vector<Evaluation> partial(pieces);
    const std::size_t width = 3 * static_cast<std::size_t>(nodes_per_tet_);
    std::vector<double> buffer(forces.empty() ? 0 : tet_count() * width, 0.0);
    parallel_for(tet_count(), tets_per_piece, [&](std::size_t begin, std::size_t end) {
        Evaluation& sum = partial[begin / tets_per_piece];
        sum.min_J = std::numeric_limits<double>::infinity();
        for (std::size_t t = begin; t < end; ++t) {
            const Evaluation one =
                evaluate_tet(t, x, law_among(laws, t), forces.empty() ? nullptr : buffer.data() + t * width);
            sum.energy_J += one.energy_J;
            sum.min_J = std::min(sum.min_J, one.min_J);
            if (!(sum.min_J > 0)) return;
        }
    });
    Evaluation total;
    total.min_J = std::numeric_limits<double>::infinity();
    for (const Evaluation& one : partial) {
        total.energy_J += one.energy_J;
        total.min_J = std::min(total.min_J, one.min_J);
    }
    if (!(total.min_J > 0) || forces.empty()) return total;
    parallel_for(use_start_.size() - 1, 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t node = begin; node < end; ++node) {
            for (int k = use_start_[node]; k < use_start_[node + 1]; ++k) {
                const double* f = buffer.data() + 3 * static_cast<std::size_t>(use_[k]);
                for (std::size_t i = 0; i < 3; ++i) forces[3 * node + i] += f[i];
            }
        }
    });
    return total;
}

void Elements::tet_tangent(std::size_t tet, std::span<const double> x, const material::Law& law, bool project,
                           double* K) const {
    const auto width = static_cast<std::size_t>(3 * nodes_per_tet_);
    std::fill(K, K + width * width, 0.0);
    std::array<std::array<double, max_tet_unknowns>, 9> HB;  // column 3b + k: change of P with unknown k of node b
    for (int q = 0; q < points_per_tet_; ++q) {
        Matrix9 H = material::tangent(law, deformation_gradient(tet, q, x));
        H = project ? linalg::project_to_positive(H) : Matrix9(0.5 * (H + H.transpose()));
        H *= point_volume(tet, q);
        const double* g = gradients(tet, q);
        for (std::size_t row = 0; row < 9; ++row) {
            for (std::size_t b = 0; b < width / 3; ++b) {
                for (std::size_t k = 0; k < 3; ++k) {
                    const auto at = [&](std::size_t l) {
                        return H(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(3 * l + k));
                    };
                    HB[row][3 * b + k] = g[3 * b] * at(0) + g[3 * b + 1] * at(1) + g[3 * b + 2] * at(2);
                }
            }
        }
        for (std::size_t a = 0; a < width / 3; ++a) {
            for (std::size_t i = 0; i < 3; ++i) {
                double* row = K + (3 * a + i) * width;
                for (std::size_t column = 3 * a; column < width; ++column) {
                    row[column] +=
                        g[3 * a] * HB[i][column] + g[3 * a + 1] * HB[3 + i][column] + g[3 * a + 2] * HB[6 + i][column];
                }
            }
        }
    }
}

void Elements::add_tangent(std::span<const double> x, const std::vector<int>& free_index,
                           const linalg::SymmetricPattern& pattern, std::span<double> values, bool project,
                           std::span<const material::Law> laws) const {
    // Batches bound the memory of the element matrices; adding them in order keeps the result reproducible.
    constexpr std::size_t batch = 2048;
    const auto width = static_cast<std::size_t>(3 * nodes_per_tet_);
    const std::size_t size = width * width;
    std::vector<double> matrices(std::min(batch, tet_count()) * size);
    for (std::size_t first = 0; first < tet_count(); first += batch) {
        const std::size_t count = std::min(batch, tet_count() - first);
        parallel_for(count, 32, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t)
                tet_tangent(first + t, x, law_among(laws, first + t), project, matrices.data() + t * size);
        });
        for (std::size_t t = 0; t < count; ++t) {
            const double* K = matrices.data() + t * size;
            const int* nodes = nodes_.data() + (first + t) * static_cast<std::size_t>(nodes_per_tet_);
            for (std::size_t b = 0; b < width / 3; ++b) {
                const int j = free_index[nodes[b]];
                for (std::size_t a = 0; j >= 0 && a < width / 3; ++a) {
                    const int i = free_index[nodes[a]];
                    if (i < j) continue;
                    // Only the upper triangle of K is filled.
                    pattern.add_block(values, i, j, [&](int r, int c) {
                        const std::size_t row = 3 * a + static_cast<std::size_t>(r);
                        const std::size_t column = 3 * b + static_cast<std::size_t>(c);
                        return a <= b ? K[row * width + column] : K[column * width + row];
                    });
                }
            }
        }
    }
}

void Elements::add_laplacian(const std::vector<int>& free_index, const linalg::SymmetricPattern& pattern,
                             std::span<double> values) const {
    for (std::size_t t = 0; t < tet_count(); ++t) {
        const int* nodes = nodes_.data() + t * static_cast<std::size_t>(nodes_per_tet_);
        const double stiffness = material::stiffness_bound(law(t));
        for (int q = 0; q < points_per_tet_; ++q) {
            const double weight = stiffness * point_volume(t, q);
            const double* g = gradients(t, q);
            for (int b = 0; b < nodes_per_tet_; ++b) {
                const int j = free_index[nodes[b]];
                for (int a = 0; j >= 0 && a < nodes_per_tet_; ++a) {
                    const int i = free_index[nodes[a]];
                    if (i < j) continue;
                    const double entry =
                        weight * (g[3 * a] * g[3 * b] + g[3 * a + 1] * g[3 * b + 1] + g[3 * a + 2] * g[3 * b + 2]);
                    pattern.add_block(values, i, j, [&](int, int) { return entry; });
                }
            }
        }
    }
}

void Elements::apply_laplacian(std::span<const double> u, std::span<double> result) const {
    for (std::size_t t = 0; t < tet_count(); ++t) {
        const int* nodes = nodes_.data() + t * static_cast<std::size_t>(nodes_per_tet_);
        const double stiffness = material::stiffness_bound(law(t));
        for (int q = 0; q < points_per_tet_; ++q) {
            const Matrix3 G = stiffness * point_volume(t, q) * deformation_gradient(t, q, u);
            const double* g = gradients(t, q);
            for (int a = 0; a < nodes_per_tet_; ++a) {
                double* r = result.data() + 3 * static_cast<std::size_t>(nodes[a]);
                for (int i = 0; i < 3; ++i)
                    r[i] += G(i, 0) * g[3 * a] + G(i, 1) * g[3 * a + 1] + G(i, 2) * g[3 * a + 2];
            }
        }
    }
}

void Elements::add_mass(const std::vector<int>& free_index, const linalg::SymmetricPattern& pattern,
                        std::span<double> values, double factor) const {
    const Eigen::MatrixXd shares = mass_shares(nodes_per_tet_);
    for (std::size_t t = 0; t < tet_count(); ++t) {
        const int* nodes = nodes_.data() + t * static_cast<std::size_t>(nodes_per_tet_);
        for (int b = 0; b < nodes_per_tet_; ++b) {
            const int j = free_index[nodes[b]];
            for (int a = 0; j >= 0 && a < nodes_per_tet_; ++a) {
                const int i = free_index[nodes[a]];
                if (i < j) continue;
                const double entry = factor * tet_mass_[t] * shares(a, b);
                pattern.add_block(values, i, j, [&](int r, int c) { return r == c ? entry : 0.0; });
            }
        }
    }
}

void Elements::apply_mass(std::span<const double> u, std::span<double> result) const {
    const Eigen::MatrixXd shares = mass_shares(nodes_per_tet_);
    for (std::size_t t = 0; t < tet_count(); ++t) {
        const int* nodes = nodes_.data() + t * static_cast<std::size_t>(nodes_per_tet_);
        for (int a = 0; a < nodes_per_tet_; ++a) {
            double* r = result.data() + 3 * static_cast<std::size_t>(nodes[a]);
            for (int b = 0; b < nodes_per_tet_; ++b) {
                const double mass = tet_mass_[t] * shares(a, b);
                const double* v = u.data() + 3 * static_cast<std::size_t>(nodes[b]);
                for (int i = 0; i < 3; ++i) r[i] += mass * v[i];
            }
        }
    }
}

std::vector<std::vector<int>> Elements::cliques(const std::vector<int>& free_index) const {
    std::vector<std::vector<int>> cliques(tet_count());
    const auto width = static_cast<std::size_t>(nodes_per_tet_);
    for (std::size_t t = 0; t < tet_count(); ++t) {
        for (std::size_t a = 0; a < width; ++a) cliques[t].push_back(free_index[nodes_[t * width + a]]);
    }
    return cliques;
}

}  // namespace pliant::sim
