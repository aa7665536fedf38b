// Forces of a joint between two things: springs stiff enough to count as rigid, and a force along the one coordinate
// that a hinge or slider leaves free.
//
// The joint depends on vectors that are linear in the nodes, y = sum of w x + f: the distances d of points of the
// second thing from the same points of the first, and directions fixed to either. With k the stiffness and n points,
//
//   ball     E = k/2 |d|^2                                one point
//   hinge    E = k/2 sum |d|^2 + U(q)                     two points of the axis; q the angle about it
//   glue     E = k/2 sum |d|^2                            four points, the corners of a regular tetrahedron
//   slider   E = k/2 (sum |d|^2 - n q^2) + U(q)           the same; q = t . mean of d, t the axis fixed to the first
//
// The slider's is k/2 min over s of sum |d - s t|^2. The angle is atan2(v . w - u . z, u . w + v . z) with u, v fixed
// to the first and w, z to the second, normal to the axis: the turn that brings u, v nearest to w, z. It does not
// depend on which pair of directions normal to the axis is taken, also where soft material shears them.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/linalg/lists.hpp"
#include "base/linalg/small.hpp"
#include "base/linalg/sparse.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim {

/// Input of a joint at one instant.
struct JointDrive {
    double wanted = 0;  ///< target position, or force along the coordinate: rad, m, N m or N
    /// The coordinate at the start of the step, with whole turns; damping resists the change from there.
    double start = 0;
    double dt = 0;  ///< length of a time step, s; 0: quasi-static, no damping
};

class JointForce {
public:
    explicit JointForce(const Joint& joint);

    /// J, and forces (3n) += its gradient. Positions x (3n) metres.
    [[nodiscard]] double energy(std::span<const double> x, const JointDrive& drive) const;
    void add_gradient(std::span<const double> x, const JointDrive& drive, std::span<double> forces) const;
    /// For a pattern (block 3) that holds all pairs of its nodes; `index` (n) of each node in it, or -1. `project`: the
    /// nearest matrix without negative eigenvalues.
    void add_hessian(std::span<const double> x, const JointDrive& drive, const std::vector<int>& index,
                     const linalg::SymmetricPattern& pattern, std::span<double> values, bool project) const;
    void append_clique(const std::vector<int>& index, linalg::Lists& cliques) const;

    /// Angle of a hinge, rad, or displacement of a slider, m; 0 at rest and for other joints. The angle is the one
    /// nearest to `start`.
    [[nodiscard]] double coordinate(std::span<const double> x, double start) const;
    /// forces (3n) += factor * its gradient.
    void add_coordinate_gradient(std::span<const double> x, double factor, std::span<double> forces) const;
    [[nodiscard]] bool has_coordinate() const { return kind_ == Joint::Kind::hinge || kind_ == Joint::Kind::slider; }
    /// -U'(q): drive, hold and damping along the coordinate, N m or N.
    [[nodiscard]] double effort(std::span<const double> x, const JointDrive& drive) const;

    /// dU'/d(wanted): for a held position minus its stiffness, for a force -1.
    [[nodiscard]] double slope_by_wanted() const;

    /// Load of the first thing on the second: force, N, and torque about the joint's point on the second, N m.
    struct Load {
        linalg::Vector3 force = linalg::Vector3::Zero(), torque = linalg::Vector3::Zero();
    };
    [[nodiscard]] Load load(std::span<const double> x, const JointDrive& drive) const;
    /// Distance of the joint's point on the second thing from that on the first, m.
    [[nodiscard]] linalg::Vector3 gap(std::span<const double> x) const;

    [[nodiscard]] double stiffness_N_m() const { return stiffness_; }
    [[nodiscard]] double arm_m() const { return arm_; }

private:
    using Vectors = Eigen::Matrix3Xd;  ///< (3, rows)
    struct Coordinate {
        double value = 0;
        Vectors gradient;
        Eigen::MatrixXd hessian;  ///< empty if not requested
    };
    /// U and its derivatives, at the coordinate q.
    struct Law {
        double energy = 0, slope = 0, curvature = 0;
    };
    [[nodiscard]] Vectors vectors(std::span<const double> x) const;
    [[nodiscard]] Coordinate coordinate_of(const Vectors& y, bool with_hessian) const;
    [[nodiscard]] Coordinate angle_of(const Vectors& y, bool with_hessian) const;
    [[nodiscard]] Coordinate place_of(const Vectors& y, bool with_hessian) const;
    /// N m/rad or N/m: holding a position, or a limit, is as stiff as the joint itself.
    [[nodiscard]] double hold() const { return kind_ == Joint::Kind::hinge ? stiffness_ * arm_ * arm_ : stiffness_; }
    [[nodiscard]] double unwrapped(double q, double start) const;
    [[nodiscard]] Law law(double q, const JointDrive& drive) const;
    /// dE/dy.
    [[nodiscard]] Vectors slopes(const Vectors& y, const JointDrive& drive) const;
    [[nodiscard]] Eigen::Index points() const;

    Joint::Kind kind_;
    double stiffness_, arm_;
    JointLaw law_;
    std::vector<int> nodes_;
    Eigen::MatrixXd weights_;        ///< (rows, nodes)
    Eigen::MatrixXd second_;         ///< (rows, nodes) the part of them that belongs to the second thing
    Vectors fixed_;                  ///< (3, rows)
    Vectors second_fixed_;           ///< (3, rows) likewise
    bool second_is_fixed_;           ///< the second thing is the world, fixed in space
    Eigen::VectorXd place_weights_;  ///< (nodes) of the joint's point on the second thing
    linalg::Vector3 place_fixed_;
};

}  // namespace pliant::sim
