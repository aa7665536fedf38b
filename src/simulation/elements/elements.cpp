#include "simulation/elements/elements.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/core/parallel.hpp"
#include "geometry/mesh/order_in_space.hpp"
#include "simulation/elements/blend_kernels.hpp"
#include "simulation/elements/mass_kernel.hpp"
#include "simulation/material/response.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim {
namespace {

using linalg::Matrix3;
using linalg::Matrix9;
using linalg::Vector3;

constexpr std::size_t batches_per_piece = 32;
constexpr std::size_t tets_per_piece = 1024;
constexpr double gauss_a = 0.58541019662496845446;  // (5 + 3 sqrt 5) / 20
constexpr double gauss_b = 0.13819660112501051518;  // (5 - sqrt 5) / 20

using Barycentric = std::array<double, 4>;

/// Forces of one batch on its nodes, (nodes_per_tet, 3, lanes).
struct BatchForces {
    alignas(64) double values[10 * 3 * batch_lanes];
};

std::vector<Barycentric> integration_points(int order) {
    if (order == 1) return {{0.25, 0.25, 0.25, 0.25}};
    std::vector<Barycentric> points(4, {gauss_b, gauss_b, gauss_b, gauss_b});
    for (std::size_t i = 0; i < 4; ++i) points[i][i] = gauss_a;
    return points;
}

/// d N_a / d b_k for the barycentric coordinates b, (nodes, 4).
using ShapeGradients = Eigen::Matrix<double, Eigen::Dynamic, 4, 0, 10, 4>;

ShapeGradients shape_gradients(int order, const Barycentric& b) {
    ShapeGradients gradients = ShapeGradients::Zero(order == 1 ? 4 : 10, 4);
    for (int i = 0; i < 4; ++i) gradients(i, i) = order == 1 ? 1 : 4 * b[i] - 1;
    if (order == 1) return gradients;
    for (int e = 0; e < 6; ++e) {
        const auto& [p, q] = mesh::edge_corners[static_cast<std::size_t>(e)];
        gradients(4 + e, p) = 4 * b[q];
        gradients(4 + e, q) = 4 * b[p];
    }
    return gradients;
}

/// d X / d (b1, b2, b3) with b0 = 1 - b1 - b2 - b3.
Matrix3 jacobian_of(const mesh::TetMesh& mesh, std::size_t tet, const ShapeGradients& dN) {
    const auto nodes = mesh.tet(tet);
    Eigen::Matrix<double, 3, 4> dX = Eigen::Matrix<double, 3, 4>::Zero();
    for (std::size_t a = 0; a < nodes.size(); ++a) {
        const Vec3& X = mesh.points[nodes[a]];
        dX += Vector3(X.x, X.y, X.z) * dN.row(static_cast<Eigen::Index>(a));
    }
    return dX.rightCols<3>().colwise() - dX.col(0);
}

/// grad N_a = J^-T d N_a / d (b1, b2, b3), stored with a stride of `batch_lanes`.
void put_gradients(const ShapeGradients& dN, const Matrix3& jacobian, double* gradients) {
    const Matrix3 inverse = jacobian.inverse().transpose();
    for (Eigen::Index a = 0; a < dN.rows(); ++a) {
        const Vector3 gradient = inverse * (dN.row(a).tail<3>().array() - dN(a, 0)).matrix().transpose();
        for (int k = 0; k < 3; ++k, gradients += batch_lanes) *gradients = gradient[k];
    }
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

std::vector<std::optional<material::InvariantForm>> forms_of(std::span<const material::Law> laws) {
    std::vector<std::optional<material::InvariantForm>> forms;
    for (const material::Law& law : laws) forms.push_back(material::invariant_form(law));
    return forms;
}

/// result (lanes) += stiffness * volume * (gradient a . gradient b).
void add_products(const double* a, const double* b, double stiffness, const double* volume, double* result) {
    constexpr std::size_t lanes = batch_lanes;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        result[lane] +=
            stiffness * volume[lane] *
            (a[lane] * b[lane] + a[lanes + lane] * b[lanes + lane] + a[2 * lanes + lane] * b[2 * lanes + lane]);
    }
}

}  // namespace

Result<Elements> Elements::create(const Description& description) {
    const mesh::TetMesh& mesh = description.mesh;
    Elements elements;
    elements.nodes_per_tet_ = mesh.nodes_per_tet();
    elements.points_per_tet_ = mesh.order == 1 ? 1 : 4;
    for (const Material& material : description.materials) {
        elements.laws_.push_back(material.law);
        elements.has_energy_ = elements.has_energy_ && material::has_energy(material.law);
    }
    elements.law_ = description.material_of_tet;
    if (elements.law_.empty()) {
        for (const int region : mesh.region) elements.law_.push_back(description.material_of_region[region]);
    }
    elements.group_by_law(mesh);
    if (Status status = elements.integrate(description); !status) return tl::unexpected(status.error());
    elements.weigh(description);
    elements.add_lumps(description);
    elements.fill_empty_lanes();
    elements.sums_ = NodeSums({elements.nodes_.data(), elements.nodes_.size()}, elements.width(), mesh.points.size());
    return elements;
}

/// Within each law, sorts tets so that neighbours in space are neighbours in memory: tets of a batch, a piece or a run
/// then share many nodes, whatever their order in the file.
void Elements::group_by_law(const mesh::TetMesh& mesh) {
    std::vector<Vec3> centre(law_.size());
    std::vector<std::vector<int>> groups(laws_.size());
    for (std::size_t t = 0; t < law_.size(); ++t) {
        for (const int node : mesh.tet(t).first(4)) centre[t] += 0.25 * mesh.points[node];
        groups[static_cast<std::size_t>(law_[t])].push_back(static_cast<int>(t));
    }
    const double layer = mesh::layer_of(mesh);
    place_.resize(law_.size());
    for (std::size_t law = 0; law < groups.size(); ++law) {
        mesh::order_in_space(groups[law], centre, layer);
        for (std::size_t k = 0; k < groups[law].size(); ++k) {
            const auto tet = static_cast<std::size_t>(groups[law][k]);
            if (k % lanes == 0) {
                batch_law_.push_back(static_cast<int>(law));
                tet_.resize(tet_.size() + lanes, no_tet);
            }
            place_[tet] = (batch_law_.size() - 1) * lanes + k % lanes;
            tet_[place_[tet]] = tet;
        }
    }
    nodes_.resize(batches() * width() * lanes);
    gradient_.resize(batches() * points() * width() * 3 * lanes);
    volume_.resize(batches() * points() * lanes);
}

/// Computes nodes, gradients and volumes. Errors: a flat tet; the message names the first one.
Status Elements::integrate(const Description& description) {
    const mesh::TetMesh& mesh = description.mesh;
    const std::vector<double>& weights = description.tet_weights;
    std::vector<ShapeGradients> shapes;
    for (const Barycentric& b : integration_points(mesh.order)) shapes.push_back(shape_gradients(mesh.order, b));
    std::vector<std::size_t> flat((mesh.tet_count() + tets_per_piece - 1) / tets_per_piece, no_tet);
    parallel_for(mesh.tet_count(), tets_per_piece, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            for (std::size_t a = 0; a < width(); ++a)
                nodes_[(place_[t] / lanes * width() + a) * lanes + place_[t] % lanes] = mesh.tet(t)[a];
            for (std::size_t q = 0; q < points(); ++q) {
                const Matrix3 jacobian = jacobian_of(mesh, t, shapes[q]);
                const double determinant = jacobian.determinant();
                if (!(determinant > 0)) flat[begin / tets_per_piece] = std::min(t, flat[begin / tets_per_piece]);
                const std::size_t point = place_[t] / lanes * points() + q, lane = place_[t] % lanes;
                volume_[point * lanes + lane] =
                    (weights.empty() ? 1 : weights[t]) * determinant / 6 / static_cast<double>(points());
                put_gradients(shapes[q], jacobian, gradient_.data() + point * width() * 3 * lanes + lane);
            }
        }
    });
    for (const std::size_t t : flat) {
        for (std::size_t q = 0; t != no_tet && q < points(); ++q) {
            const double volume = jacobian_of(mesh, t, shapes[q]).determinant() / 6;
            if (volume > 0) continue;
            return input_error("tetrahedron {} of the mesh is flat or inside out at rest (volume {:.3g} m^3)", t,
                               volume);
        }
    }
    return {};
}

/// Computes masses of tets and nodes.
void Elements::weigh(const Description& description) {
    const mesh::TetMesh& mesh = description.mesh;
    for (const Barycentric& b : integration_points(mesh.order)) shapes_.push_back(mesh::shape_functions(mesh.order, b));
    node_mass_.assign(mesh.points.size(), 0.0);
    tet_mass_.assign(mesh.tet_count(), 0.0);
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const double density = description.materials[law_[t]].density_kg_m3;
        for (std::size_t q = 0; q < points(); ++q) {
            const double mass = density * point_volume(t, static_cast<int>(q));
            tet_mass_[t] += mass;
            for (std::size_t a = 0; a < width(); ++a) node_mass_[mesh.tet(t)[a]] += mass * shapes_[q][a];
        }
    }
}

/// Adds a quarter of an object's mass at each of its nodes, and the point masses.
void Elements::add_lumps(const Description& description) {
    for (const FreeObject& object : description.objects) {
        object_nodes_.push_back(object.nodes);
        for (const int node : object.nodes) lumps_.push_back({{node}, {1.0}, object.mass_kg / 4});
    }
    for (const PointMass& mass : description.masses)
        lumps_.push_back({mass.point.nodes, mass.point.weights, mass.mass_kg});
    for (const Lump& lump : lumps_) {
        for (std::size_t a = 0; a < lump.nodes.size(); ++a)
            node_mass_[static_cast<std::size_t>(lump.nodes[a])] += lump.weights[a] * lump.mass_kg;
    }
}

/// Unused lanes in the last batch of a law repeat its first tet, with zero volume.
void Elements::fill_empty_lanes() {
    for (std::size_t place = 0; place < tet_.size(); ++place) {
        if (tet_[place] != no_tet) continue;
        const std::size_t batch = place / lanes;
        const std::size_t lane = place % lanes;
        for (std::size_t a = 0; a < width(); ++a) {
            int* nodes = nodes_.data() + (batch * width() + a) * lanes;
            nodes[lane] = nodes[0];
        }
        for (std::size_t k = 0; k < points() * width() * 3; ++k) {
            double* gradients = gradient_.data() + (batch * points() * width() * 3 + k) * lanes;
            gradients[lane] = gradients[0];
        }
        for (std::size_t q = 0; q < points(); ++q) volume_[(batch * points() + q) * lanes + lane] = 0;
    }
}

TetBatch Elements::batch(std::size_t b) const {
    return {nodes_per_tet_, points_per_tet_, nodes_.data() + b * width() * lanes,
            gradient_.data() + b * points() * width() * 3 * lanes, volume_.data() + b * points() * lanes};
}

Matrix3 Elements::deformation_gradient(std::size_t tet, int point, std::span<const double> x) const {
    Matrix3 F = Matrix3::Zero();
    for (int a = 0; a < nodes_per_tet_; ++a) {
        const double* g = gradient(tet, point, a);
        const double* xa = x.data() + 3 * static_cast<std::size_t>(node(tet, a));
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i < 3; ++i) F(i, j) += xa[i] * g[static_cast<std::size_t>(j) * lanes];
        }
    }
    return F;
}

BatchResult Elements::forces_one_by_one(std::size_t batch, std::span<const double> x, const material::Law& law,
                                        double* forces) const {
    BatchResult result{0, std::numeric_limits<double>::infinity()};
    if (forces != nullptr) std::fill_n(forces, 3 * width() * lanes, 0.0);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::size_t tet = tet_[batch * lanes + lane];
        for (int q = 0; tet != no_tet && q < points_per_tet_; ++q) {
            const Matrix3 F = deformation_gradient(tet, q, x);
            const double J = F.determinant();
            // A NaN must count as inverted, hence this form of the comparison.
            result.min_J = J > 0 ? std::min(result.min_J, J) : -1;
            if (!(J > 0)) return result;
            const double volume = point_volume(tet, q);
            if (const auto density = material::energy(law, F)) result.energy_J += volume * *density;
            if (forces == nullptr) continue;
            const Matrix3 P = volume * material::stress(law, F);
            for (int a = 0; a < nodes_per_tet_; ++a) {
                const double* g = gradient(tet, q, a);
                double* f = forces + static_cast<std::size_t>(3 * a) * lanes + lane;
                for (std::size_t i = 0; i < 3; ++i)
                    f[i * lanes] += P(i, 0) * g[0] + P(i, 1) * g[lanes] + P(i, 2) * g[2 * lanes];
            }
        }
    }
    return result;
}

/// result (3n) += what `forces_of(batch, forces)` writes for the nodes of each batch.
template <class ForcesOf>
void Elements::add_batches(std::span<double> result, const ForcesOf& forces_of) const {
    const auto lists = scratch_.lend(sums_.space());
    sums_.for_pieces([&](std::size_t piece, std::size_t begin, std::size_t end) {
        BatchForces forces;
        sums_.clear(piece, lists.data());
        for (std::size_t b = begin; b < end; ++b) {
            forces_of(b, forces.values);
            sums_.add(b, forces.values, lists.data());
        }
    });
    sums_.gather(lists.data(), result);
}

Elements::Evaluation Elements::evaluate(std::span<const double> x, std::span<double> forces) const {
    std::vector<Evaluation> partial(sums_.pieces());
    const bool with_forces = !forces.empty();
    const auto lists = scratch_.lend(with_forces ? sums_.space() : 0);
    const auto forms = forms_of(laws_);
    sums_.for_pieces([&](std::size_t piece, std::size_t begin, std::size_t end) {
        BatchForces one;
        double* to = with_forces ? one.values : nullptr;
        if (with_forces) sums_.clear(piece, lists.data());
        Evaluation& sum = partial[piece];
        sum.min_J = std::numeric_limits<double>::infinity();
        for (std::size_t b = begin; b < end && sum.min_J > 0; ++b) {
            const auto& form = forms[static_cast<std::size_t>(batch_law_[b])];
            const auto* blend = std::get_if<material::ShapeBlend>(&law_of_batch(b));
            const BatchResult result = form    ? batch_forces(batch(b), *form, x.data(), to)
                                       : blend ? batch_blend_forces(batch(b), *blend, x.data(), to)
                                               : forces_one_by_one(b, x, law_of_batch(b), to);
            sum.energy_J += result.energy_J;
            sum.min_J = std::min(sum.min_J, result.min_J);
            if (with_forces && sum.min_J > 0) sums_.add(b, one.values, lists.data());
        }
    });
    Evaluation total;
    total.min_J = std::numeric_limits<double>::infinity();
    for (const Evaluation& one : partial) {
        total.energy_J += one.energy_J;
        total.min_J = std::min(total.min_J, one.min_J);
    }
    if (total.min_J > 0 && with_forces) sums_.gather(lists.data(), forces);
    return total;
}

void Elements::add_laplacian(const BlockSums& sums, std::span<double> values) const {
    const auto fill = [&](std::size_t b, double* products) {
        const double stiffness = material::stiffness_bound(law_of_batch(b));
        std::fill_n(products, pairs() * lanes, 0.0);
        for (std::size_t q = 0; q < points(); ++q) {
            const double* gradients = gradient_.data() + (b * points() + q) * width() * 3 * lanes;
            const double* volume = volume_.data() + (b * points() + q) * lanes;
            double* product = products;
            for (std::size_t j = 0; j < width(); ++j) {
                for (std::size_t i = 0; i <= j; ++i, product += lanes)
                    add_products(gradients + i * 3 * lanes, gradients + j * 3 * lanes, stiffness, volume, product);
            }
        }
    };
    sums.add(fill, 1, values, scratch_);
}

void Elements::apply_laplacian(std::span<const double> u, std::span<double> result) const {
    for (std::size_t t = 0; t < tet_count(); ++t) {
        const double stiffness = material::stiffness_bound(law(t));
        for (int q = 0; q < points_per_tet_; ++q) {
            const Matrix3 G = stiffness * point_volume(t, q) * deformation_gradient(t, q, u);
            for (int a = 0; a < nodes_per_tet_; ++a) {
                const double* g = gradient(t, q, a);
                double* r = result.data() + 3 * static_cast<std::size_t>(node(t, a));
                for (int i = 0; i < 3; ++i) r[i] += G(i, 0) * g[0] + G(i, 1) * g[lanes] + G(i, 2) * g[2 * lanes];
            }
        }
    }
}

void Elements::add_rotation_term(const RotatingStep& rotating, std::span<double> result) const {
    add_batches(result, [&](std::size_t b, double* forces) {
        batch_rotation_term(batch(b), rotating, material::stiffness_bound(law_of_batch(b)), forces);
    });
}

void Elements::find_rotations(std::span<const double> before, std::span<const double> now,
                              AlignedArray<double>& rotations) const {
    const std::size_t stride = 9 * points() * lanes;
    rotations.resize(batches() * stride);
    parallel_for(batches(), batches_per_piece, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b)
            batch_rotations(batch(b), before.data(), now.data(), rotations.data() + b * stride);
    });
}

void Elements::add_rotated(const AlignedArray<double>& rotations, Direction direction, std::span<const double> u,
                           std::span<double> result) const {
    const std::size_t stride = 9 * points() * lanes;
    add_batches(result, [&](std::size_t b, double* forces) {
        batch_rotated(batch(b), rotations.data() + b * stride, direction == Direction::back, u.data(),
                      material::stiffness_bound(law_of_batch(b)), forces);
    });
}

Elements::LaneMasses Elements::lane_masses(std::size_t batch, std::span<const double> tet_mass) const {
    LaneMasses masses;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::size_t tet = tet_[batch * lanes + lane];
        if (tet != no_tet) masses.values[lane] = tet_mass[tet];
    }
    return masses;
}

void Elements::add_mass(const BlockSums& sums, const std::vector<int>& free_index,
                        const linalg::SymmetricPattern& pattern, std::span<double> values, double factor) const {
    const auto fill = [&, shares = mass_shares(nodes_per_tet_)](std::size_t b, double* entries) {
        const LaneMasses mass = lane_masses(b, tet_mass_);
        for (int j = 0; j < nodes_per_tet_; ++j) {
            for (int i = 0; i <= j; ++i, entries += lanes) {
                for (std::size_t lane = 0; lane < lanes; ++lane)
                    entries[lane] = factor * mass.values[lane] * shares(i, j);
            }
        }
    };
    const auto entries = scratch_.lend(pattern.node_row.size());
    parallel_clear({entries.data(), pattern.node_row.size()});
    sums.add(fill, 1, {entries.data(), pattern.node_row.size()}, scratch_);
    for (std::size_t k = 0; k < pattern.node_row.size(); ++k) {
        for (const std::size_t on_diagonal : {0, 4, 8}) values[9 * k + on_diagonal] += entries.data()[k];
    }
    for (const Lump& lump : lumps_) {
        for (std::size_t b = 0; b < lump.nodes.size(); ++b) {
            const int j = free_index[lump.nodes[b]];
            for (std::size_t a = 0; j >= 0 && a < lump.nodes.size(); ++a) {
                const int i = free_index[lump.nodes[a]];
                const double entry = factor * lump.mass_kg * lump.weights[a] * lump.weights[b];
                if (i >= j) pattern.add_block(values, i, j, [&](int r, int c) { return r == c ? entry : 0.0; });
            }
        }
    }
}

void Elements::apply_mass(std::span<const double> u, std::span<double> result) const {
    apply_mass(tet_mass_, u, result);
    for (const Lump& lump : lumps_) {
        for (std::size_t i = 0; i < 3; ++i) {
            double mean = 0;
            for (std::size_t a = 0; a < lump.nodes.size(); ++a)
                mean += lump.weights[a] * u[3 * static_cast<std::size_t>(lump.nodes[a]) + i];
            for (std::size_t a = 0; a < lump.nodes.size(); ++a)
                result[3 * static_cast<std::size_t>(lump.nodes[a]) + i] += lump.mass_kg * lump.weights[a] * mean;
        }
    }
}

void Elements::apply_mass(std::span<const double> tet_mass, std::span<const double> u, std::span<double> result) const {
    const Eigen::MatrixXd shares = mass_shares(nodes_per_tet_);
    add_batches(result, [&](std::size_t b, double* forces) {
        const LaneMasses mass = lane_masses(b, tet_mass);
        batch_momentum(batch(b), mass.values, shares.data(), u.data(), forces);
    });
}

std::vector<double> Elements::mass_products(std::span<const double> u, std::span<const double> v) const {
    const Eigen::MatrixXd shares = mass_shares(nodes_per_tet_);
    std::vector<double> products(tet_count(), 0.0);
    for (std::size_t t = 0; t < tet_count(); ++t) {
        for (int a = 0; a < nodes_per_tet_; ++a) {
            const double* ua = u.data() + 3 * static_cast<std::size_t>(node(t, a));
            for (int b = 0; b < nodes_per_tet_; ++b) {
                const double* vb = v.data() + 3 * static_cast<std::size_t>(node(t, b));
                products[t] += shares(a, b) * (ua[0] * vb[0] + ua[1] * vb[1] + ua[2] * vb[2]);
            }
        }
    }
    return products;
}

linalg::Lists Elements::cliques(const std::vector<int>& free_index) const {
    linalg::Lists cliques;
    cliques.item.resize(tet_count() * width());
    cliques.start.resize(tet_count() + 1);
    parallel_for(tet_count(), tets_per_piece, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            cliques.start[t + 1] = static_cast<int>((t + 1) * width());
            for (std::size_t a = 0; a < width(); ++a)
                cliques.item[t * width() + a] = free_index[node(t, static_cast<int>(a))];
        }
    });
    for (const Lump& lump : lumps_) {
        std::vector<int> clique;
        for (const int node : lump.nodes) clique.push_back(free_index[static_cast<std::size_t>(node)]);
        cliques.push_back(clique);
    }
    return cliques;
}

}  // namespace pliant::sim
