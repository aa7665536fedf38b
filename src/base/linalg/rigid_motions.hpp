// Rigid motions of a group of nodes.
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/linalg/small.hpp"

namespace pliant::linalg {

/// The six motions of a group of nodes as a rigid body, orthonormal over its nodes. `positions` (all nodes, 3).
class RigidMotions {
public:
    static constexpr int count = 6;
    using OfNode = Eigen::Matrix<double, 3, count>;  ///< one motion per column

    RigidMotions(std::span<const int> nodes, std::span<const double> positions);

    [[nodiscard]] OfNode at(std::span<const double> positions, int node) const;
    /// True if the nodes are too few to tell this motion from those before it; it is then zero.
    [[nodiscard]] bool dropped(int motion) const { return combined_.col(motion).isZero(0); }

private:
    using Square = Eigen::Matrix<double, count, count>;
    [[nodiscard]] OfNode plain(const Vector3& position) const;
    void orthonormalise(const Square& products, double nodes);

    Vector3 middle_;
    double scale_ = 0;
    Square combined_ = Square::Identity();
};

/// The rotation that best maps the nodes from their positions `before` to those `now`.
[[nodiscard]] Matrix3 rotation_between(std::span<const int> nodes, std::span<const double> before,
                                       std::span<const double> now);

}  // namespace pliant::linalg
