#include "simulation/actuators/chamber_surface.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "base/linalg/dense.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/actuators/cross_matrix.hpp"
#include "simulation/actuators/face_sample.hpp"

namespace pliant::sim {
namespace {

using linalg::Matrix3;

/// The integrand, position times normal, is of degree 1 on a plane face (one point) and of degree 4 on a curved one
/// (six points; Dunavant 1985).
const std::vector<FaceSample>& samples(bool quadratic) {
    static const std::vector<FaceSample> one = {linear_sample(0.5, {1.0 / 3, 1.0 / 3, 1.0 / 3})};
    static const std::vector<FaceSample> six = [] {
        std::vector<FaceSample> list;
        constexpr std::array<std::array<double, 2>, 2> orbits = {
            {{0.109951743655322, 0.091576213509771}, {0.223381589678011, 0.445948490915965}}};
        for (const auto& [weight, a] : orbits) {
            for (std::size_t i = 0; i < 3; ++i) {
                std::array<double, 3> b = {a, a, a};
                b[i] = 1 - 2 * a;
                list.push_back(quadratic_sample(0.5 * weight, b));
            }
        }
        return list;
    }();
    return quadratic ? six : one;
}

std::size_t points_of(const WallFace& face) {
    return face[3] < 0 ? 3 : 6;
}

/// x, x_u and x_v of a face at one sample.
std::array<Vec3, 3> place(const WallFace& face, const FaceSample& s, const std::vector<Vec3>& p) {
    std::array<Vec3, 3> sum;
    for (std::size_t i = 0; i < points_of(face); ++i) {
        const Vec3& point = p[static_cast<std::size_t>(face[i])];
        sum[0] += s.N[i] * point;
        sum[1] += s.Nu[i] * point;
        sum[2] += s.Nv[i] * point;
    }
    return sum;
}

using FaceMatrix = std::array<std::array<Matrix3, 6>, 6>;

/// factor * d(dV/dx_i)/dx_j of one face, not symmetric. Only blocks of points that exist on the face are set.
FaceMatrix second_gradient(const WallFace& face, double factor, const std::vector<Vec3>& points) {
    FaceMatrix between;
    const std::size_t count = points_of(face);
    for (std::size_t i = 0; i < count; ++i) std::fill_n(between[i].begin(), count, Matrix3::Zero());
    for (const FaceSample& s : samples(count == 6)) {
        const auto [at, u, v] = place(face, s, points);
        const Matrix3 U = factor * s.weight * cross_matrix(linalg::vector(u));
        const Matrix3 V = factor * s.weight * cross_matrix(linalg::vector(v));
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t j = 0; j < count; ++j) between[i][j] += s.N[i] * (s.Nv[j] * U - s.Nu[j] * V);
        }
    }
    return between;
}

/// (3 count, 3 count), projected to the nearest positive semi-definite matrix on request.
Eigen::MatrixXd symmetric_part(const FaceMatrix& blocks, Eigen::Index count, bool project) {
    Eigen::MatrixXd matrix(3 * count, 3 * count);
    for (Eigen::Index i = 0; i < count; ++i) {
        for (Eigen::Index j = 0; j < count; ++j) {
            const auto row = static_cast<std::size_t>(i);
            const auto column = static_cast<std::size_t>(j);
            matrix.block<3, 3>(3 * i, 3 * j) = 0.5 * (blocks[row][column] + blocks[column][row].transpose());
        }
    }
    return project ? linalg::positive_part(matrix) : matrix;
}

}  // namespace

ChamberSurface::ChamberSurface(const Wall& wall, std::span<const double> rest) : wall_(wall) {
    const std::vector<Vec3> points = points_at(rest);
    for (const Vec3& p : points) centre_ += p / static_cast<double>(points.size());
}

std::vector<Vec3> ChamberSurface::points_at(std::span<const double> x) const {
    std::vector<Vec3> points;
    points.reserve(wall_.points.size());
    for (const Attachment& point : wall_.points) points.push_back(position(point, x));
    return points;
}

double ChamberSurface::volume(std::span<const double> x) const {
    const std::vector<Vec3> points = points_at(x);
    double sum = 0;
    for (const WallFace& face : wall_.faces) {
        for (const FaceSample& s : samples(points_of(face) == 6)) {
            const auto [at, u, v] = place(face, s, points);
            sum += s.weight * dot(at - centre_, cross(u, v)) / 3;
        }
    }
    return sum;
}

void ChamberSurface::add_gradient(std::span<const double> x, double factor, std::span<double> forces) const {
    add_gradient_of(wall_.faces, x, factor, forces);
}

void ChamberSurface::add_force(std::span<const double> x, double factor, std::span<double> forces) const {
    add_gradient_of(wall_.faces_of_bodies(), x, factor, forces);
}

void ChamberSurface::add_gradient_of(std::span<const WallFace> faces, std::span<const double> x, double factor,
                                     std::span<double> forces) const {
    const std::vector<Vec3> points = points_at(x);
    std::vector<Vec3> on_points(points.size());
    for (const WallFace& face : faces) {
        for (const FaceSample& s : samples(points_of(face) == 6)) {
            const auto [at, u, v] = place(face, s, points);
            const Vec3 n = (factor * s.weight) * cross(u, v);
            for (std::size_t i = 0; i < points_of(face); ++i)
                on_points[static_cast<std::size_t>(face[i])] += s.N[i] * n;
        }
    }
    spread(on_points, forces);
}

void ChamberSurface::spread(std::span<const Vec3> on_points, std::span<double> on_nodes) const {
    for (std::size_t p = 0; p < on_points.size(); ++p) {
        const Attachment& point = wall_.points[p];
        for (std::size_t k = 0; k < point.nodes.size(); ++k) {
            double* target = on_nodes.data() + 3 * static_cast<std::size_t>(point.nodes[k]);
            target[0] += point.weights[k] * on_points[p].x;
            target[1] += point.weights[k] * on_points[p].y;
            target[2] += point.weights[k] * on_points[p].z;
        }
    }
}

void ChamberSurface::add_hessian(std::span<const double> x, double factor, const std::vector<int>& free_index,
                                 const linalg::SymmetricPattern& pattern, std::span<double> values,
                                 bool project) const {
    const std::vector<Vec3> points = points_at(x);
    for (const WallFace& face : wall_.faces_of_bodies()) {
        const auto count = static_cast<Eigen::Index>(points_of(face));
        const Eigen::MatrixXd symmetric = symmetric_part(second_gradient(face, factor, points), count, project);
        for (Eigen::Index i = 0; i < count; ++i) {
            for (Eigen::Index j = 0; j < count; ++j) {
                add_pair(face[static_cast<std::size_t>(i)], face[static_cast<std::size_t>(j)],
                         symmetric.block<3, 3>(3 * i, 3 * j), free_index, pattern, values);
            }
        }
    }
}

void ChamberSurface::add_pair(int first, int second, const linalg::Matrix3& block, const std::vector<int>& free_index,
                              const linalg::SymmetricPattern& pattern, std::span<double> values) const {
    const Attachment& a = wall_.points[static_cast<std::size_t>(first)];
    const Attachment& b = wall_.points[static_cast<std::size_t>(second)];
    for (std::size_t l = 0; l < b.nodes.size(); ++l) {
        const int j = free_index[static_cast<std::size_t>(b.nodes[l])];
        if (j < 0) continue;
        for (std::size_t k = 0; k < a.nodes.size(); ++k) {
            const int i = free_index[static_cast<std::size_t>(a.nodes[k])];
            if (i < j) continue;
            const double weight = a.weights[k] * b.weights[l];
            pattern.add_block(values, i, j, [&](int r, int c) { return weight * block(r, c); });
        }
    }
}

void ChamberSurface::apply_skew(std::span<const double> x, double factor, std::span<const double> v,
                                std::span<double> result) const {
    const std::vector<Vec3> points = points_at(x);
    std::vector<Vec3> motions;
    for (const Attachment& point : wall_.points) motions.push_back(motion(point, v));
    std::vector<Vec3> on_points(points.size());
    for (const WallFace& face : wall_.faces_of_bodies()) {
        const FaceMatrix between = second_gradient(face, 0.5 * factor, points);
        for (std::size_t i = 0; i < points_of(face); ++i) {
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (std::size_t j = 0; j < points_of(face); ++j) {
                const Vec3& m = motions[static_cast<std::size_t>(face[j])];
                sum += (between[i][j] - between[j][i].transpose()) * Eigen::Vector3d(m.x, m.y, m.z);
            }
            on_points[static_cast<std::size_t>(face[i])] += Vec3{sum[0], sum[1], sum[2]};
        }
    }
    spread(on_points, result);
}

void ChamberSurface::add_skew(std::span<const double> x, double factor, const std::vector<int>& index,
                              const linalg::SymmetricPattern& pattern, std::span<double> values) const {
    const std::vector<Vec3> points = points_at(x);
    for (const WallFace& face : wall_.faces_of_bodies()) {
        const FaceMatrix between = second_gradient(face, 0.5 * factor, points);
        for (std::size_t i = 0; i < points_of(face); ++i) {
            for (std::size_t j = 0; j < points_of(face); ++j)
                add_pair(face[i], face[j], between[i][j] - between[j][i].transpose(), index, pattern, values);
        }
    }
}

void ChamberSurface::append_cliques(const std::vector<int>& free_index, linalg::Lists& cliques) const {
    for (const WallFace& face : wall_.faces) {
        std::vector<int> clique;
        for (std::size_t i = 0; i < points_of(face); ++i) {
            for (const int node : wall_.points[static_cast<std::size_t>(face[i])].nodes)
                clique.push_back(free_index[static_cast<std::size_t>(node)]);
        }
        std::sort(clique.begin(), clique.end());
        clique.erase(std::unique(clique.begin(), clique.end()), clique.end());
        cliques.push_back(clique);
    }
}

std::vector<int> rim_points(const Wall& wall) {
    struct Edge {
        int balance = 0;  ///< uses in one direction minus uses in the other
        int middle = -1;
    };
    std::map<std::pair<int, int>, Edge> edges;
    for (const WallFace& face : wall.faces) {
        for (std::size_t i = 0; i < 3; ++i) {
            const int a = face[i];
            const int b = face[(i + 1) % 3];
            Edge& edge = edges[std::minmax(a, b)];
            edge.balance += a < b ? 1 : -1;
            edge.middle = face[3 + i];
        }
    }
    std::set<int> rim;
    for (const auto& [ends, edge] : edges) {
        if (edge.balance == 0) continue;
        rim.insert({ends.first, ends.second});
        if (edge.middle >= 0) rim.insert(edge.middle);
    }
    return {rim.begin(), rim.end()};
}

}  // namespace pliant::sim
