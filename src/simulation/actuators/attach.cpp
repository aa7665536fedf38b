#include "simulation/actuators/attach.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/mesh/curved_point.hpp"

namespace pliant::sim {
namespace {

constexpr std::size_t largest_patch = 64;
constexpr double reach_beyond = 1.05;  // times the distance of the farthest node of the tet that contains the point
constexpr double on_plane = 1e-6;      // of the reach: nearer to a plane counts as on it

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

/// Barycentric offset (sum 0) from the nearest point of a tet to `point`; zero if the tet is so flat that this would
/// exceed its own size.
std::array<double, 4> beyond(const mesh::TetMesh& mesh, const mesh::TetLocator::Location& at, const Vec3& point) {
    const auto nodes = mesh::nodes_of(mesh, static_cast<std::size_t>(at.tet));
    const auto column = mesh::curved_derivative(nodes, at.barycentric);
    const auto vector = [](const Vec3& v) { return Eigen::Vector3d(v.x, v.y, v.z); };
    Eigen::Matrix3d jacobian;
    for (int k = 0; k < 3; ++k) jacobian.col(k) = vector(column[static_cast<std::size_t>(k) + 1] - column[0]);
    const Eigen::Vector3d off = vector(point - mesh::curved_position(nodes, at.barycentric));
    const Eigen::Vector3d d = jacobian.inverse() * off;
    if (!d.allFinite() || d.cwiseAbs().maxCoeff() > 1 || std::fabs(d.sum()) > 1 ||
        (jacobian * d - off).norm() > 1e-9 * off.norm())
        return {};
    return {-d.sum(), d[0], d[1], d[2]};
}

/// The shape functions at `b`, extrapolated linearly by `step`.
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

/// w_i = k_i m_i . a with M a = (1, 0, 0, 0), M = sum k_i m_i m_i^T, m_i = (1, o_i), k_i = (1 - o_i . o_i)^2 and
/// o_i = (X_i - point) / reach.
class MovingLeastSquares {
public:
    MovingLeastSquares(const std::vector<Vec3>& points, const Vec3& point, double reach)
        : reach_(reach), moments_(static_cast<Eigen::Index>(points.size()), 4), kernel_(moments_.rows()) {
        for (Eigen::Index i = 0; i < kernel_.size(); ++i) {
            const Vec3 offset = (points[static_cast<std::size_t>(i)] - point) / reach;
            moments_.row(i) << 1, offset.x, offset.y, offset.z;
            const double fall = 1 - dot(offset, offset);
            kernel_[i] = fall * fall;
        }
        matrix_ = moments_.transpose() * kernel_.asDiagonal() * moments_;
        a_ = matrix_.ldlt().solve(Eigen::Vector4d::Unit(0));
        weights_ = kernel_.asDiagonal() * (moments_ * a_);
    }
    /// True if they reproduce affine functions.
    [[nodiscard]] bool good() const {
        return weights_.allFinite() && !((moments_.transpose() * weights_ - Eigen::Vector4d::Unit(0)).norm() > 1e-9);
    }
    [[nodiscard]] const Eigen::VectorXd& weights() const { return weights_; }
    /// (nodes, 3) 1/m: contribution of each node to the gradient of the best-fitting affine motion.
    [[nodiscard]] Eigen::MatrixXd gradients() const {
        const Eigen::Matrix<double, 4, 3> slopes = matrix_.ldlt().solve(Eigen::Matrix<double, 4, 3>(
            (Eigen::Matrix<double, 4, 3>() << Eigen::RowVector3d::Zero(), Eigen::Matrix3d::Identity()).finished()));
        return kernel_.asDiagonal() * (moments_ * slopes) / reach_;
    }
    /// True if the gradients reproduce affine functions.
    [[nodiscard]] bool good_slope() const {
        const Eigen::MatrixXd sums = moments_.transpose() * gradients() * reach_;
        return sums.allFinite() && !(sums.topRows<1>().norm() > 1e-9) &&
               !((sums.bottomRows<3>() - Eigen::Matrix3d::Identity()).norm() > 1e-9);
    }
    /// Derivative of the weights as the point moves along `direction` and the reach grows by `of_reach`.
    [[nodiscard]] Eigen::VectorXd change(const Eigen::Vector3d& direction, double of_reach) const {
        const Eigen::MatrixXd offsets = moments_.rightCols<3>();
        Eigen::MatrixXd moments = Eigen::MatrixXd::Zero(moments_.rows(), 4);
        moments.rightCols<3>() = -of_reach / reach_ * offsets;
        moments.rightCols<3>().rowwise() -= direction.transpose() / reach_;
        const Eigen::VectorXd fall = 1 - offsets.rowwise().squaredNorm().array();
        const Eigen::VectorXd kernel =
            -4 * fall.array() * offsets.cwiseProduct(moments.rightCols<3>()).rowwise().sum().array();
        const Eigen::Matrix4d half = moments.transpose() * kernel_.asDiagonal() * moments_;
        const Eigen::Matrix4d matrix = moments_.transpose() * kernel.asDiagonal() * moments_ + half + half.transpose();
        const Eigen::Vector4d a = matrix_.ldlt().solve(-matrix * a_);
        return kernel.cwiseProduct(moments_ * a_) + kernel_.cwiseProduct(moments * a_ + moments_ * a);
    }

private:
    double reach_;
    Eigen::MatrixXd moments_;  ///< (nodes, 4)
    Eigen::VectorXd kernel_;
    Eigen::Matrix4d matrix_;
    Eigen::Vector4d a_;
    Eigen::VectorXd weights_;
};

}  // namespace

Attachment AffinePatch::at(const Vec3& point) const {
    if (nodes.empty()) return {{}, {}, point};
    Attachment attachment{nodes, weights, {}};
    for (std::size_t k = 0; k < nodes.size(); ++k) attachment.weights[k] += dot(slopes[k], point - center);
    return attachment;
}

/// w(p) = k_i m_i . M^-1 (1, p - c) with M = sum k_i m_i m_i^T and m_i = (1, X_i - c), lengths divided by the reach.
std::optional<AffinePatch> fitted_patch(std::vector<int> nodes, std::span<const double> importance,
                                        const std::vector<Vec3>& points, const Vec3& center) {
    constexpr double flat = 1e-9;
    AffinePatch patch{std::move(nodes), {}, {}, center, 0};
    for (const int node : patch.nodes)
        patch.reach = std::max(patch.reach, norm(points[static_cast<std::size_t>(node)] - center));
    const auto n = static_cast<Eigen::Index>(patch.nodes.size());
    Eigen::MatrixXd moments(n, 4);
    for (Eigen::Index i = 0; i < n; ++i) {
        const int node = patch.nodes[static_cast<std::size_t>(i)];
        const Vec3 off = (points[static_cast<std::size_t>(node)] - center) / patch.reach;
        moments.row(i) << 1, off.x, off.y, off.z;
    }
    const Eigen::Map<const Eigen::VectorXd> kernel(importance.data(), n);
    const Eigen::Matrix4d M = moments.transpose() * kernel.asDiagonal() * moments;
    const Eigen::Matrix4d inverse = M.ldlt().solve(Eigen::Matrix4d::Identity());
    const Eigen::MatrixXd basis = kernel.asDiagonal() * (moments * inverse);
    if (!basis.allFinite() || !((moments.transpose() * basis - Eigen::Matrix4d::Identity()).norm() < flat))
        return std::nullopt;
    for (Eigen::Index i = 0; i < n; ++i) {
        patch.weights.push_back(basis(i, 0));
        patch.slopes.push_back(Vec3{basis(i, 1), basis(i, 2), basis(i, 3)} / patch.reach);
    }
    return patch;
}

const KeptPatches::Patch* KeptPatches::find(const Vec3& point, double radius, std::size_t tet_count,
                                            const std::function<bool(const Patch&)>& fits) const {
    constexpr double near = 0.01;  // of the reach: the copies differ by far less
    const Patch* nearest = nullptr;
    double distance = std::numeric_limits<double>::infinity();
    for (const Patch& patch : patches_) {
        const double off = norm(patch.point - point);
        const bool alike =
            patch.tet_count == tet_count && std::fabs(patch.radius - radius) <= near * std::max(patch.radius, radius);
        if (!alike || off > near * patch.reach || off >= distance || !fits(patch)) continue;
        nearest = &patch;
        distance = off;
    }
    return nearest;
}

Attacher::Attacher(const mesh::TetMesh& mesh, KeptPatches* kept)
    : mesh_(&mesh), locator_(mesh), tet_start_(mesh.points.size() + 1, 0), kept_(kept) {
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

double Attacher::edge_of_tet(const Vec3& point) const {
    const auto nodes = mesh_->tet(static_cast<std::size_t>(locator_.locate(point).tet));
    double longest = 0;
    for (std::size_t a = 0; a < 4; ++a) {
        for (std::size_t b = 0; b < a; ++b)
            longest = std::max(longest, norm(mesh_->points[static_cast<std::size_t>(nodes[a])] -
                                             mesh_->points[static_cast<std::size_t>(nodes[b])]));
    }
    return longest;
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

bool Attacher::has(int node) const {
    const auto n = static_cast<std::size_t>(node);
    return n + 1 < tet_start_.size() && tet_start_[n] < tet_start_[n + 1];
}

std::optional<Attacher::Patch> Attacher::kept_patch(const Vec3& point, double radius) const {
    if (kept_ == nullptr || !kept_->closed()) return std::nullopt;
    const auto fits = [&](const KeptPatches::Patch& patch) {
        return std::ranges::all_of(patch.nodes, [&](int node) { return has(node); });
    };
    const KeptPatches::Patch* found = kept_->find(point, radius, mesh_->tet_count(), fits);
    if (found == nullptr) return std::nullopt;
    const int f = found->farthest;
    return Patch{found->nodes, f < 0 ? radius : reach_beyond * norm(mesh_->points[static_cast<std::size_t>(f)] - point),
                 f};
}

Attacher::Patch Attacher::patch_at(int tet, const Vec3& point, double radius) const {
    if (std::optional<Patch> kept = kept_patch(point, radius)) return *std::move(kept);
    Patch patch;
    patch.reach = radius;
    for (const int node : mesh_->tet(static_cast<std::size_t>(tet))) {
        const double wanted = reach_beyond * norm(mesh_->points[static_cast<std::size_t>(node)] - point);
        if (wanted > patch.reach) patch.farthest = node;
        patch.reach = std::max(patch.reach, wanted);
    }
    patch.nodes = connected_nodes_within(tet, point, patch.reach);
    thin_out(patch.nodes, mesh_->points, point);
    if (kept_ != nullptr && !kept_->closed())
        kept_->add({point, radius, mesh_->tet_count(), patch.nodes, patch.reach, patch.farthest});
    return patch;
}

Eigen::VectorXd Attacher::Images::gathered(const Eigen::VectorXd& values) const {
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(of.empty() ? 0 : 1 + *std::max_element(of.begin(), of.end()));
    for (std::size_t k = 0; k < of.size(); ++k) sums[of[k]] += values[static_cast<Eigen::Index>(k)];
    return sums;
}

/// True if the point lies on the plane, and its patch on one side of it, held wherever it touches it.
bool Attacher::mirrors(const SymmetryPlane& plane, const Patch& patch, const Vec3& point) const {
    const double near = on_plane * patch.reach;
    if (std::fabs(dot(plane.normal, point - plane.point)) > near) return false;
    double lowest = 0, highest = 0;
    for (const int node : patch.nodes) {
        const double height = dot(plane.normal, mesh_->points[static_cast<std::size_t>(node)] - plane.point);
        if (std::fabs(height) <= near && !plane.holds[static_cast<std::size_t>(node)]) return false;
        lowest = std::min(lowest, height);
        highest = std::max(highest, height);
    }
    return std::min(-lowest, highest) <= near;
}

Attacher::Images Attacher::images_of(const Patch& patch, const Vec3& point,
                                     std::span<const SymmetryPlane> planes) const {
    Images images;
    for (std::size_t k = 0; k < patch.nodes.size(); ++k) {
        images.places.push_back(mesh_->points[static_cast<std::size_t>(patch.nodes[k])]);
        images.of.push_back(static_cast<int>(k));
    }
    for (const SymmetryPlane& plane : planes) {
        const auto at_right_angles = [&](const Vec3& normal) {
            return std::fabs(dot(normal, plane.normal)) < on_plane;
        };
        if (!mirrors(plane, patch, point) || !std::ranges::all_of(images.normals, at_right_angles)) continue;
        images.normals.push_back(plane.normal);
        const std::size_t count = images.places.size();
        for (std::size_t k = 0; k < count; ++k) {
            const double height = dot(plane.normal, images.places[k] - plane.point);
            if (std::fabs(height) <= on_plane * patch.reach) continue;  // its own image
            images.places.push_back(images.places[k] - 2 * height * plane.normal);
            images.of.push_back(images.of[k]);
        }
    }
    return images;
}

Result<Attachment> Attacher::spread(const Vec3& point, double radius, double tolerance,
                                    std::span<const SymmetryPlane> planes) const {
    if (radius <= 0) return carried_by_tet(point, tolerance);
    const auto location = locate(point, tolerance);
    if (!location) return tl::unexpected(location.error());
    Patch patch = patch_at(location->tet, point, radius);
    const Images images = images_of(patch, point, planes);
    const MovingLeastSquares fit(images.places, point, patch.reach);
    if (!fit.good()) return carried_by_tet(point, tolerance);
    const Eigen::VectorXd weights = images.gathered(fit.weights());
    Attachment attachment{std::move(patch.nodes), {weights.data(), weights.data() + weights.size()}, {}};
    Vec3 mean;
    for (std::size_t k = 0; k < attachment.nodes.size(); ++k)
        mean += attachment.weights[k] * mesh_->points[static_cast<std::size_t>(attachment.nodes[k])];
    for (const Vec3& normal : images.normals) attachment.fixed += dot(normal, point - mean) * normal;
    return attachment;
}

Result<AffinePatch> Attacher::patch(const Vec3& point, double radius, double tolerance) const {
    const auto location = locate(point, tolerance);
    if (!location) return tl::unexpected(location.error());
    Patch found = patch_at(location->tet, point, radius);
    std::vector<double> kernel;
    for (const int node : found.nodes) {
        const double share = norm(mesh_->points[static_cast<std::size_t>(node)] - point) / found.reach;
        kernel.push_back((1 - share * share) * (1 - share * share));
    }
    std::optional<AffinePatch> patch = fitted_patch(std::move(found.nodes), kernel, mesh_->points, point);
    if (!patch) return input_error("its nodes lie in one plane");
    return *std::move(patch);
}

Result<AttachedFrame> Attacher::frame(const Vec3& point, double radius, double tolerance) const {
    const auto location = locate(point, tolerance);
    if (!location) return tl::unexpected(location.error());
    Patch patch = patch_at(location->tet, point, radius);
    std::vector<Vec3> places;
    for (const int node : patch.nodes) places.push_back(mesh_->points[static_cast<std::size_t>(node)]);
    const MovingLeastSquares fit(places, point, patch.reach);
    AttachedFrame frame;
    if (fit.good() && fit.good_slope()) {
        const Eigen::MatrixXd gradients = fit.gradients();
        frame.nodes = std::move(patch.nodes);
        frame.weights.assign(fit.weights().data(), fit.weights().data() + fit.weights().size());
        for (Eigen::Index i = 0; i < gradients.rows(); ++i)
            frame.gradients.push_back({gradients(i, 0), gradients(i, 1), gradients(i, 2)});
        return frame;
    }
    const AttachmentSlope slope = slope_in_tet(*location);
    frame.nodes = slope.nodes;
    frame.gradients = slope.weights;
    frame.weights.assign(frame.nodes.size(), 0);
    const Result<Attachment> carried = carried_by_tet(point, tolerance);
    for (std::size_t k = 0; carried && k < carried->nodes.size(); ++k) {
        const auto at = std::find(frame.nodes.begin(), frame.nodes.end(), carried->nodes[k]);
        frame.weights[static_cast<std::size_t>(at - frame.nodes.begin())] = carried->weights[k];
    }
    return frame;
}

Result<AttachmentSlope> Attacher::slope(const Vec3& point, double radius, double tolerance,
                                        std::span<const SymmetryPlane> planes) const {
    const auto location = locate(point, tolerance);
    if (!location) return tl::unexpected(location.error());
    if (radius <= 0) return slope_in_tet(*location);
    Patch patch = patch_at(location->tet, point, radius);
    const Images images = images_of(patch, point, planes);
    const MovingLeastSquares fit(images.places, point, patch.reach);
    if (!fit.good()) return slope_in_tet(*location);
    Vec3 of_reach;
    if (patch.farthest >= 0)
        of_reach = reach_beyond * unit(point - mesh_->points[static_cast<std::size_t>(patch.farthest)]);
    AttachmentSlope slope{std::move(patch.nodes), {}};
    const std::array<Eigen::VectorXd, 3> by = {images.gathered(fit.change({1, 0, 0}, of_reach.x)),
                                               images.gathered(fit.change({0, 1, 0}, of_reach.y)),
                                               images.gathered(fit.change({0, 0, 1}, of_reach.z))};
    for (Eigen::Index i = 0; i < by[0].size(); ++i) slope.weights.push_back({by[0][i], by[1][i], by[2][i]});
    return slope;
}

/// Outside a tet its shape functions are extrapolated linearly from the nearest point, so the slope is that at this
/// point.
AttachmentSlope Attacher::slope_in_tet(const mesh::TetLocator::Location& at) const {
    const auto corners = mesh::nodes_of(*mesh_, static_cast<std::size_t>(at.tet));
    const auto column = mesh::curved_derivative(corners, at.barycentric);
    Eigen::Matrix3d jacobian;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 edge = column[k + 1] - column[0];
        jacobian.col(static_cast<Eigen::Index>(k)) << edge.x, edge.y, edge.z;
    }
    const Eigen::Matrix3d inverse = jacobian.inverse();
    const auto nodes = mesh_->tet(static_cast<std::size_t>(at.tet));
    AttachmentSlope slope{{nodes.begin(), nodes.end()}, std::vector<Vec3>(nodes.size())};
    const std::vector<double> here = mesh::shape_functions(mesh_->order, at.barycentric);
    for (std::size_t c = 0; c < 3; ++c) {
        const Eigen::Vector3d d = inverse.col(static_cast<Eigen::Index>(c));
        const std::vector<double> on = weights_beyond(mesh_->order, at.barycentric, {-d.sum(), d[0], d[1], d[2]});
        for (std::size_t a = 0; a < nodes.size(); ++a) slope.weights[a][c] = on[a] - here[a];
    }
    return slope;
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
