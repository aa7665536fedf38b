#include "base/linalg/rigid_motions.hpp"

#include <algorithm>
#include <cmath>

#include "base/linalg/vectors.hpp"

namespace pliant::linalg {
namespace {

Vector3 middle_of(std::span<const int> nodes, std::span<const double> positions) {
    Vector3 sum = Vector3::Zero();
    for (const int i : nodes) sum += view(positions, i);
    return sum / static_cast<double>(nodes.size());
}

}  // namespace

RigidMotions::RigidMotions(std::span<const int> nodes, std::span<const double> positions)
    : middle_(middle_of(nodes, positions)) {
    double reach = 0;
    for (const int i : nodes) reach = std::max(reach, (view(positions, i) - middle_).norm());
    if (reach > 0) scale_ = 1 / reach;
    Square products = Square::Zero();
    for (const int i : nodes) {
        const OfNode motion = plain(view(positions, i));
        products += motion.transpose() * motion;
    }
    orthonormalise(products, static_cast<double>(nodes.size()));
}

RigidMotions::OfNode RigidMotions::at(std::span<const double> positions, int node) const {
    return plain(view(positions, node)) * combined_;
}

/// Translations, and rotations about the centre.
RigidMotions::OfNode RigidMotions::plain(const Vector3& position) const {
    const Vector3 arm = scale_ * (position - middle_);
    OfNode m;
    m << 1, 0, 0, 0, arm.z(), -arm.y(),  //
        0, 1, 0, -arm.z(), 0, arm.x(),   //
        0, 0, 1, arm.y(), -arm.x(), 0;
    return m;
}

/// Gram-Schmidt, using the inner products of the plain motions.
void RigidMotions::orthonormalise(const Square& products, double nodes) {
    constexpr double dependent = 1e-4;
    for (int c = 0; c < count; ++c) {
        auto column = combined_.col(c);
        for (int before = 0; before < c; ++before)
            column -= combined_.col(before).dot(products.col(c)) * combined_.col(before);
        const double squared = column.dot(products * column);
        if (squared > dependent * nodes)
            column /= std::sqrt(squared);
        else
            column.setZero();
    }
}

Matrix3 rotation_between(std::span<const int> nodes, std::span<const double> before, std::span<const double> now) {
    const Vector3 from = middle_of(nodes, before);
    const Vector3 to = middle_of(nodes, now);
    Matrix3 together = Matrix3::Zero();
    for (const int i : nodes) together += (view(now, i) - to) * (view(before, i) - from).transpose();
    return nearest_rotation(together);
}

}  // namespace pliant::linalg
