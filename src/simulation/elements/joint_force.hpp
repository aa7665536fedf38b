// What a joint does to the two things that it joins: springs stiff enough to count as rigid, and what acts along the
// one coordinate that a hinge and a slider leave open.
//
// The joint knows vectors that are linear in the nodes, y = sum of w x + f: how far points of the second thing are from
// the same points of the first, d, and directions that are fixed to either. With k the stiffness and n points,
//
//   ball     E = k/2 |d|^2                                one point
//   hinge    E = k/2 sum |d|^2 + U(q)                     two points of the axis; q the angle about it
//   glue     E = k/2 sum |d|^2                            three points that are not on one line
//   slider   E = k/2 (sum |d|^2 - n q^2) + U(q)           the same; q = t . mean of d, t the axis as the first has it
//
// The slider's is k/2 min over s of sum |d - s t|^2. The angle is atan2(v . w, u . w) with u, v of the first and w of
// the second, normal to the axis.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/linalg/lists.hpp"
#include "base/linalg/small.hpp"
#include "base/linalg/sparse.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim {

/// What a joint is given at one instant.
struct JointDrive {
    double wanted = 0;  ///< place, or force along the coordinate: rad, m, N m or N
    /// The coordinate where the step begins, with whole turns; what damps resists the way from there.
    double start = 0;
    double dt = 0;  ///< of a step in time, s; 0: at rest at every instant, nothing damps
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

    /// Angle of a hinge, rad, or place of a slider, m; 0 at rest and of what has neither. Of an angle the one that is
    /// nearest to `start`.
    [[nodiscard]] double coordinate(std::span<const double> x, double start) const;
    /// forces (3n) += factor * its gradient.
    void add_coordinate_gradient(std::span<const double> x, double factor, std::span<double> forces) const;
    [[nodiscard]] bool has_coordinate() const { return kind_ == Joint::Kind::hinge || kind_ == Joint::Kind::slider; }
    /// -U'(q): what drives, holds and damps it, N m or N.
    [[nodiscard]] double effort(std::span<const double> x, const JointDrive& drive) const;

    /// How U' changes with what is wanted: of a place that is held minus that stiffness, of a force minus one.
    [[nodiscard]] double slope_by_wanted() const;

    /// What the first thing does to the second, N, and about where the joint is on the second, N m.
    struct Load {
        linalg::Vector3 force = linalg::Vector3::Zero(), torque = linalg::Vector3::Zero();
    };
    [[nodiscard]] Load load(std::span<const double> x, const JointDrive& drive) const;
    /// How far the joint's point of the second thing is from that of the first, m.
    [[nodiscard]] linalg::Vector3 gap(std::span<const double> x) const;

    [[nodiscard]] double stiffness_N_m() const { return stiffness_; }
    [[nodiscard]] double arm_m() const { return arm_; }

private:
    using Vectors = Eigen::Matrix3Xd;  ///< (3, rows)
    struct Coordinate {
        double value = 0;
        Vectors gradient;
        Eigen::MatrixXd hessian;  ///< empty where it was not asked for
    };
    /// U and its derivatives, at the coordinate q.
    struct Law {
        double energy = 0, slope = 0, curvature = 0;
    };
    [[nodiscard]] Vectors vectors(std::span<const double> x) const;
    [[nodiscard]] Coordinate coordinate_of(const Vectors& y, bool with_hessian) const;
    [[nodiscard]] Coordinate angle_of(const Vectors& y, bool with_hessian) const;
    [[nodiscard]] Coordinate place_of(const Vectors& y, bool with_hessian) const;
    /// N m/rad or N/m: what holds at a place, or at a limit, is as stiff as what joins.
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
    Eigen::MatrixXd second_;         ///< (rows, nodes) the part of them that is the second thing's
    Vectors fixed_;                  ///< (3, rows)
    Vectors second_fixed_;           ///< (3, rows) likewise
    bool second_is_fixed_;           ///< in space: it is the world
    Eigen::VectorXd place_weights_;  ///< (nodes) of the joint's point on the second thing
    linalg::Vector3 place_fixed_;
};

}  // namespace pliant::sim
