#include "simulation/actuators/attach.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/mesh/curved_point.hpp"

namespace pliant::sim {
namespace {

constexpr std::size_t largest_patch = 64;

/// Keeps the nearest nodes and an even sample of the others.
void thin_out(std::vector<int>& nodes, const std::vector<Vec3>& points, const Vec3& center) {
    if (nodes.size() <= largest_patch) return;
    std::sort(nodes.begin(), nodes.end(), [&](int a, int b) {
        const double da = norm(points[a] - center);
        const double db = norm(points[b] - center);
        return da != db ? da < db : a < b;
    });
    std::vector<int> kept;
    for (std::size_t k = 0; k < largest_patch; ++k) kept.push_back(nodes[k * (nodes.size() - 1) / (largest_patch - 1)]);
    nodes = std::move(kept);
}

/// How far beyond the nearest point of a tet `point` lies, in its barycentric coordinates there (sum 0); none where the
/// tet is so flat that this would be more than once through it.
std::array<double, 4> beyond(const mesh::TetMesh& mesh, const mesh::TetLocator::Location& at, const Vec3& point) {
    const auto nodes = mesh::nodes_of(mesh, static_cast<std::size_t>(at.tet));
    const auto column = mesh::curved_derivative(nodes, at.barycentric);
    const auto vector = [](const Vec3& v) { return Eigen::Vector3d(v.x, v.y, v.z); };
    Eigen::Matrix3d jacobian;
    for (int k = 0; k < 3; ++k) jacobian.col(k) = vector(column[static_cast<std::size_t>(k) + 1] - column[0]);
    const Eigen::Vector3d off = vector(point - mesh::curved_position(nodes, at.barycentric));
    const Eigen::Vector3d d = jacobian.fullPivLu().solve(off);
    if (!d.allFinite() || d.cwiseAbs().maxCoeff() > 1 || std::fabs(d.sum()) > 1 ||
        (jacobian * d - off).norm() > 1e-9 * off.norm())
        return {};
    return {-d.sum(), d[0], d[1], d[2]};
}

/// The shape functions at `b`, gone on with along their slope by `step`.
std::vector<double> weights_beyond(int order, const std::array<double, 4>& b, const std::array<double, 4>& step) {
    std::vector<double> weights = mesh::shape_functions(order, b);
    for (std::size_t k = 0; k < 4; ++k) weights[k] += order == 1 ? step[k] : (4 * b[k] - 1) * step[k];
    for (std::size_t e = 0; e + 4 < weights.size(); ++e) {
        const auto i = static_cast<std::size_t>(mesh::edge_corners[e][0]);
        const auto j = static_cast<std::size_t>(mesh::edge_corners[e][1]);
        weights[4 + e] += 4 * (b[i] * step[j] + b[j] * step[i]);
    }
    return weights;
}

}  // namespace

Attacher::Attacher(const mesh::TetMesh& mesh) : mesh_(&mesh), locator_(mesh), tet_start_(mesh.points.size() + 1, 0) {
    for (const int node : mesh.nodes) ++tet_start_[static_cast<std::size_t>(node) + 1];
    for (std::size_t i = 0; i < mesh.points.size(); ++i) tet_start_[i + 1] += tet_start_[i];
    tets_.resize(mesh.nodes.size());
    std::vector<int> next(tet_start_.begin(), tet_start_.end() - 1);
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        for (const int node : mesh.tet(t)) tets_[next[node]++] = static_cast<int>(t);
    }
}

Result<mesh::TetLocator::Location> Attacher::locate(const Vec3& point, double tolerance) const {
    const mesh::TetLocator::Location location = locator_.locate(point);
    if (location.distance > tolerance) return input_error("{}", location.distance);
    return location;
}

Result<Attachment> Attacher::carried_by_tet(const Vec3& point, double tolerance) const {
    const auto location = locate(point, tolerance);
    if (!location) return tl::unexpected(location.error());
    const auto nodes = mesh_->tet(static_cast<std::size_t>(location->tet));
    std::array<double, 4> step{};
    if (location->distance > 0) step = beyond(*mesh_, *location, point);
    const auto weights = weights_beyond(mesh_->order, location->barycentric, step);
    Attachment attachment;
    for (std::size_t a = 0; a < nodes.size(); ++a) {
        if (weights[a] == 0) continue;
        attachment.nodes.push_back(nodes[a]);
        attachment.weights.push_back(weights[a]);
    }
    return attachment;
}

std::vector<int> Attacher::connected_nodes_within(int tet, const Vec3& point, double radius) const {
    std::vector<int> found;
    std::vector<bool> seen(mesh_->points.size(), false);
    const auto visit = [&](int node) {
        if (seen[node] || norm(mesh_->points[node] - point) >= radius) return;
        seen[node] = true;
        found.push_back(node);
    };
    for (const int node : mesh_->tet(static_cast<std::size_t>(tet))) visit(node);
    for (std::size_t next = 0; next < found.size(); ++next) {
        const int node = found[next];
        for (int k = tet_start_[node]; k < tet_start_[node + 1]; ++k) {
            for (const int other : mesh_->tet(static_cast<std::size_t>(tets_[k]))) visit(other);
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

Result<Attachment> Attacher::spread(const Vec3& point, double radius, double tolerance) const {
    if (radius <= 0) return carried_by_tet(point, tolerance);
    const auto location = locate(point, tolerance);
    if (!location) return tl::unexpected(location.error());
    double reach = radius;
    for (const int node : mesh_->tet(static_cast<std::size_t>(location->tet))) {
        reach = std::max(reach, 1.05 * norm(mesh_->points[node] - point));
    }
    std::vector<int> nodes = connected_nodes_within(location->tet, point, reach);
    thin_out(nodes, mesh_->points, point);

    Eigen::MatrixXd moments(nodes.size(), 4);
    Eigen::VectorXd kernel(static_cast<Eigen::Index>(nodes.size()));
    for (Eigen::Index i = 0; i < kernel.size(); ++i) {
        const Vec3 offset = (mesh_->points[nodes[static_cast<std::size_t>(i)]] - point) / reach;
        moments.row(i) << 1, offset.x, offset.y, offset.z;
        const double fall = 1 - dot(offset, offset);
        kernel[i] = fall * fall;
    }
    const Eigen::Matrix4d M = moments.transpose() * kernel.asDiagonal() * moments;
    const Eigen::Vector4d a = M.ldlt().solve(Eigen::Vector4d::Unit(0));
    const Eigen::VectorXd weights = kernel.asDiagonal() * (moments * a);
    if (!weights.allFinite() || (moments.transpose() * weights - Eigen::Vector4d::Unit(0)).norm() > 1e-9) {
        return carried_by_tet(point, tolerance);
    }
    return Attachment{std::move(nodes), {weights.data(), weights.data() + weights.size()}, {}};
}

Wall wall_of_faces(const mesh::TetMesh& mesh, std::span<const mesh::Face> faces, std::span<const int> index) {
    Wall wall;
    std::vector<int> point(mesh.points.size(), -1);
    for (const mesh::Face& face : faces) {
        WallFace corners{};
        for (std::size_t i = 0; i < 6; ++i) {
            const int node = face.nodes[i];
            corners[i] = -1;
            if (node < 0) continue;
            const auto n = static_cast<std::size_t>(node);
            if (point[n] < 0) {
                point[n] = static_cast<int>(wall.points.size());
                wall.points.push_back(index[n] >= 0 ? Attachment{{index[n]}, {1.0}, {}}
                                                    : Attachment{{}, {}, mesh.points[n]});
            }
            corners[i] = point[n];
        }
        wall.faces.push_back(corners);
    }
    return wall;
}

}  // namespace pliant::sim
