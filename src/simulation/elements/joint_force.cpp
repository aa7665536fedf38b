#include "simulation/elements/joint_force.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/linalg/dense.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/elements/node_blocks.hpp"

namespace pliant::sim {
namespace {

using linalg::Matrix3;
using linalg::Vector3;

/// Rows of the vectors that each kind needs, by the points of both things (centre, and an arm along each axis).
struct RowOf {
    std::array<double, 4> first, second;
};

/// Distance of the second thing from the first at the point that lies by these parts of each arm from the centre.
RowOf offset_at(const std::array<double, 3>& arms) {
    RowOf row{{-1, 0, 0, 0}, {1, 0, 0, 0}};
    for (std::size_t k = 0; k < 3; ++k) {
        row.first[0] += arms[k], row.first[k + 1] -= arms[k];
        row.second[0] -= arms[k], row.second[k + 1] += arms[k];
    }
    return row;
}

/// Distances at the corners of a regular tetrahedron. Their mean is that of the centre, and the sum of their squares
/// does not depend on how the tetrahedron lies, also where the things deform.
std::vector<RowOf> corner_offsets() {
    const double c = 1 / std::numbers::sqrt3;
    return {offset_at({c, c, c}), offset_at({c, -c, -c}), offset_at({-c, c, -c}), offset_at({-c, -c, c})};
}

std::vector<RowOf> rows_of(Joint::Kind kind, double arm) {
    const double a = 1 / arm;
    switch (kind) {
        case Joint::Kind::ball:
            return {offset_at({0, 0, 0})};
        case Joint::Kind::glue:
            return corner_offsets();
        case Joint::Kind::slider: {
            std::vector<RowOf> rows = corner_offsets();
            rows.push_back({{-a, a, 0, 0}, {0, 0, 0, 0}});
            return rows;
        }
        case Joint::Kind::hinge:
            break;
    }
    return {{{0, -1, 0, 0}, {0, 1, 0, 0}}, {{-2, 1, 0, 0}, {2, -1, 0, 0}}, {{-a, 0, a, 0}, {0, 0, 0, 0}},
            {{-a, 0, 0, a}, {0, 0, 0, 0}}, {{0, 0, 0, 0}, {-a, 0, a, 0}},  {{0, 0, 0, 0}, {-a, 0, 0, a}}};
}

Eigen::Index place_in(std::vector<int>& nodes, int node) {
    const auto found = std::ranges::find(nodes, node);
    if (found != nodes.end()) return found - nodes.begin();
    nodes.push_back(node);
    return static_cast<Eigen::Index>(nodes.size()) - 1;
}

void add_to_nodes(const std::vector<int>& nodes, const Eigen::Matrix3Xd& on_nodes, std::span<double> forces) {
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        Eigen::Map<Vector3> force(forces.data() + 3 * static_cast<std::size_t>(nodes[k]));
        force += on_nodes.col(static_cast<Eigen::Index>(k));
    }
}

}  // namespace

JointForce::JointForce(const Joint& joint)
    : kind_(joint.kind), stiffness_(joint.stiffness_N_m), arm_(joint.arm_m), law_(joint.law) {
    for (const auto* end : {&joint.first, &joint.second}) {
        for (const Attachment& point : *end)
            for (const int node : point.nodes) (void)place_in(nodes_, node);
    }
    const std::vector<RowOf> rows = rows_of(kind_, arm_);
    const auto m = static_cast<Eigen::Index>(rows.size()), n = static_cast<Eigen::Index>(nodes_.size());
    weights_ = second_ = Eigen::MatrixXd::Zero(m, n);
    fixed_ = second_fixed_ = Vectors::Zero(3, m);
    const auto add = [&](const Attachment& point, double factor, Eigen::Index row, Eigen::MatrixXd& weights,
                         Vectors& fixed) {
        if (factor == 0) return;
        fixed.col(row) += factor * linalg::vector(point.fixed);
        for (std::size_t k = 0; k < point.nodes.size(); ++k)
            weights(row, place_in(nodes_, point.nodes[k])) += factor * point.weights[k];
    };
    for (Eigen::Index row = 0; row < m; ++row) {
        for (std::size_t p = 0; p < 4; ++p) {
            add(joint.second[p], rows[static_cast<std::size_t>(row)].second[p], row, second_, second_fixed_);
            add(joint.first[p], rows[static_cast<std::size_t>(row)].first[p], row, weights_, fixed_);
        }
    }
    weights_ += second_;
    fixed_ += second_fixed_;
    second_is_fixed_ = joint.second[0].nodes.empty();
    Eigen::MatrixXd place = Eigen::MatrixXd::Zero(1, n);
    Vectors at = Vectors::Zero(3, 1);
    add(joint.second[0], 1, 0, place, at);
    place_weights_ = place.row(0).transpose();
    place_fixed_ = at.col(0);
}

/// Number of rows that are offsets of points.
Eigen::Index JointForce::points() const {
    switch (kind_) {
        case Joint::Kind::ball:
            return 1;
        case Joint::Kind::hinge:
            return 2;
        case Joint::Kind::glue:
        case Joint::Kind::slider:
            break;
    }
    return 4;
}

JointForce::Vectors JointForce::vectors(std::span<const double> x) const {
    Vectors at(3, static_cast<Eigen::Index>(nodes_.size()));
    for (Eigen::Index k = 0; k < at.cols(); ++k) at.col(k) = linalg::view(x, nodes_[static_cast<std::size_t>(k)]);
    return at * weights_.transpose() + fixed_;
}

JointForce::Coordinate JointForce::angle_of(const Vectors& y, bool with_hessian) const {
    const Vector3 u = y.col(2), v = y.col(3), w = y.col(4), z = y.col(5);
    const double a = u.dot(w) + v.dot(z), b = v.dot(w) - u.dot(z), r2 = a * a + b * b;
    const double by_a = -b / r2, by_b = a / r2;
    Vectors da = Vectors::Zero(3, y.cols()), db = da;
    da.rightCols<4>() << w, z, u, v;
    db.rightCols<4>() << -z, w, v, -u;
    Coordinate q{std::atan2(b, a), by_a * da + by_b * db, {}};
    if (!with_hessian) return q;
    const double aa = 2 * a * b / (r2 * r2), ab = (b * b - a * a) / (r2 * r2);
    const Eigen::VectorXd A = da.reshaped(), B = db.reshaped();
    q.hessian = aa * (A * A.transpose() - B * B.transpose()) + ab * (A * B.transpose() + B * A.transpose());
    const auto add = [&](Eigen::Index first, Eigen::Index second, double factor) {
        q.hessian.block<3, 3>(3 * first, 3 * second) += factor * Matrix3::Identity();
        q.hessian.block<3, 3>(3 * second, 3 * first) += factor * Matrix3::Identity();
    };
    add(2, 4, by_a);
    add(3, 5, by_a);
    add(3, 4, by_b);
    add(2, 5, -by_b);
    return q;
}

JointForce::Coordinate JointForce::place_of(const Vectors& y, bool with_hessian) const {
    constexpr Eigen::Index n = 4;  // offsets, before the axis
    const double length = y.col(n).norm();
    const Vector3 t = y.col(n) / length, d = y.leftCols<n>().rowwise().mean();
    const double s = t.dot(d);
    const Vector3 off = d - s * t;
    Coordinate q{s, Vectors::Zero(3, n + 1), {}};
    for (Eigen::Index k = 0; k < n; ++k) q.gradient.col(k) = t / n;
    q.gradient.col(n) = off / length;
    if (!with_hessian) return q;
    const Matrix3 across = Matrix3::Identity() - t * t.transpose();
    q.hessian = Eigen::MatrixXd::Zero(3 * (n + 1), 3 * (n + 1));
    for (Eigen::Index k = 0; k < n; ++k) {
        q.hessian.block<3, 3>(3 * k, 3 * n) = across / (n * length);
        q.hessian.block<3, 3>(3 * n, 3 * k) = across / (n * length);
    }
    q.hessian.block<3, 3>(3 * n, 3 * n) = -(off * t.transpose() + t * off.transpose() + s * across) / (length * length);
    return q;
}

JointForce::Coordinate JointForce::coordinate_of(const Vectors& y, bool with_hessian) const {
    return kind_ == Joint::Kind::hinge ? angle_of(y, with_hessian) : place_of(y, with_hessian);
}

double JointForce::unwrapped(double q, double start) const {
    if (kind_ != Joint::Kind::hinge) return q;
    return start + std::remainder(q - start, 2 * std::numbers::pi);
}

double JointForce::coordinate(std::span<const double> x, double start) const {
    return has_coordinate() ? unwrapped(coordinate_of(vectors(x), false).value, start) : 0;
}

JointForce::Law JointForce::law(double q, const JointDrive& drive) const {
    Law all;
    const auto spring = [&](double stiffness, double off) {
        all.energy += 0.5 * stiffness * off * off;
        all.slope += stiffness * off;
        all.curvature += stiffness;
    };
    spring(law_.stiffness, q - law_.rest);
    if (drive.dt > 0) spring(law_.damping / drive.dt, q - drive.start);
    if (q < law_.low) spring(hold(), q - law_.low);
    if (q > law_.high) spring(hold(), q - law_.high);
    if (law_.drive == JointLaw::Drive::place) spring(hold(), q - drive.wanted);
    if (law_.drive == JointLaw::Drive::force) {
        all.energy -= drive.wanted * q;
        all.slope -= drive.wanted;
    }
    return all;
}

double JointForce::slope_by_wanted() const {
    switch (law_.drive) {
        case JointLaw::Drive::place:
            return -hold();
        case JointLaw::Drive::force:
            return -1;
        case JointLaw::Drive::none:
            break;
    }
    return 0;
}

double JointForce::effort(std::span<const double> x, const JointDrive& drive) const {
    return has_coordinate() ? 0 - law(coordinate(x, drive.start), drive).slope : 0;
}

double JointForce::energy(std::span<const double> x, const JointDrive& drive) const {
    const Vectors y = vectors(x);
    double sum = 0.5 * stiffness_ * y.leftCols(points()).squaredNorm();
    if (!has_coordinate()) return sum;
    const double q = coordinate_of(y, false).value;
    if (kind_ == Joint::Kind::slider) sum -= 0.5 * stiffness_ * static_cast<double>(points()) * q * q;
    return sum + law(unwrapped(q, drive.start), drive).energy;
}

JointForce::Vectors JointForce::slopes(const Vectors& y, const JointDrive& drive) const {
    Vectors by = Vectors::Zero(3, y.cols());
    by.leftCols(points()) = stiffness_ * y.leftCols(points());
    if (!has_coordinate()) return by;
    const Coordinate q = coordinate_of(y, false);
    double slope = law(unwrapped(q.value, drive.start), drive).slope;
    if (kind_ == Joint::Kind::slider) slope -= stiffness_ * static_cast<double>(points()) * q.value;
    return by + slope * q.gradient;
}

void JointForce::add_gradient(std::span<const double> x, const JointDrive& drive, std::span<double> forces) const {
    add_to_nodes(nodes_, slopes(vectors(x), drive) * weights_, forces);
}

void JointForce::add_coordinate_gradient(std::span<const double> x, double factor, std::span<double> forces) const {
    if (!has_coordinate() || factor == 0) return;
    add_to_nodes(nodes_, factor * coordinate_of(vectors(x), false).gradient * weights_, forces);
}

void JointForce::add_hessian(std::span<const double> x, const JointDrive& drive, const std::vector<int>& index,
                             const linalg::SymmetricPattern& pattern, std::span<double> values, bool project) const {
    const Vectors y = vectors(x);
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(3 * y.cols(), 3 * y.cols());
    H.topLeftCorner(3 * points(), 3 * points()).diagonal().setConstant(stiffness_);
    if (has_coordinate()) {
        const Coordinate q = coordinate_of(y, true);
        Law U = law(unwrapped(q.value, drive.start), drive);
        if (kind_ == Joint::Kind::slider) {
            U.slope -= stiffness_ * static_cast<double>(points()) * q.value;
            U.curvature -= stiffness_ * static_cast<double>(points());
        }
        const Eigen::Map<const Eigen::VectorXd> g(q.gradient.data(), q.gradient.size());
        H += U.curvature * g * g.transpose() + U.slope * q.hessian;
    }
    if (project) H = linalg::positive_part(H);
    // H times the weights of each node, (3 rows, 3).
    std::vector<Eigen::MatrixXd> columns(nodes_.size(), Eigen::MatrixXd::Zero(H.rows(), 3));
    for (std::size_t b = 0; b < nodes_.size(); ++b) {
        for (Eigen::Index l = 0; l < y.cols(); ++l)
            columns[b] += weights_(l, static_cast<Eigen::Index>(b)) * H.middleCols(3 * l, 3);
    }
    add_node_blocks(nodes_, index, pattern, values, [&](std::size_t a, std::size_t b) {
        Matrix3 block = Matrix3::Zero();
        for (Eigen::Index k = 0; k < y.cols(); ++k)
            block += weights_(k, static_cast<Eigen::Index>(a)) * columns[b].middleRows(3 * k, 3);
        return block;
    });
}

void JointForce::append_clique(const std::vector<int>& index, linalg::Lists& cliques) const {
    append_node_clique(nodes_, index, cliques);
}

/// Total force and torque on the second thing, on its nodes and its fixed points, about the joint's point there.
JointForce::Load JointForce::load(std::span<const double> x, const JointDrive& drive) const {
    const Vectors by = slopes(vectors(x), drive);
    Vector3 place = place_fixed_;
    for (std::size_t k = 0; k < nodes_.size(); ++k)
        place += place_weights_[static_cast<Eigen::Index>(k)] * linalg::view(x, nodes_[k]);
    Load load;
    load.force = -by.leftCols(points()).rowwise().sum();
    const Vectors on_nodes = by * second_;
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
        const Vector3 arm = linalg::view(x, nodes_[k]) - place;
        load.torque -= arm.cross(on_nodes.col(static_cast<Eigen::Index>(k)));
    }
    // Rows hold fixed points times their factors, which sum to 1 for an offset and to 0 for a direction.
    for (Eigen::Index row = 0; second_is_fixed_ && row < by.cols(); ++row) {
        const Vector3 arm = row < points() ? Vector3(second_fixed_.col(row) - place) : Vector3(second_fixed_.col(row));
        load.torque -= arm.cross(Vector3(by.col(row)));
    }
    return load;
}

Vector3 JointForce::gap(std::span<const double> x) const {
    return vectors(x).leftCols(points()).rowwise().mean();
}

}  // namespace pliant::sim
