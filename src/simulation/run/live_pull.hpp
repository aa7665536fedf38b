// A spring between a point of the body and a handle, and the force at which both balance.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "simulation/solver/curvature.hpp"
#include "simulation/stepper/robot_state.hpp"

namespace pliant::sim {

struct Pull {
    Attachment point;
    Vec3 handle_m;
};

/// The spring is much stiffer than the body, so that the point follows the handle closely. The compliance of the body
/// at the point is estimated from its motion.
class PullSpring {
public:
    /// Both must outlive it.
    PullSpring(const Equilibrium& system, const FactoredLaplacian& laplacian);

    void let_go() { pull_.reset(); }
    /// Sets the pull; true if it acts on another point than before, so that the force on the last one is gone.
    bool take_up(const Pull& pull, const RobotState& robot);
    [[nodiscard]] const std::optional<Pull>& pull() const { return pull_; }

    /// The estimated force at which the spring and the body balance; `force_N` is the current force.
    [[nodiscard]] Eigen::Vector3d balance(const Eigen::VectorXd& x, const Eigen::Vector3d& force_N) const;
    [[nodiscard]] bool is_settled(const Eigen::VectorXd& x, const Eigen::Vector3d& force_N) const;
    /// Size of a change of the force, measured by the motion of the point, in units that are usually solved in one
    /// increment.
    [[nodiscard]] double distance(const Eigen::Vector3d& change_N) const;

    /// Updates the compliance with the motion caused by a change of the force alone.
    void learn(const Eigen::Vector3d& change_N, const Vec3& moved_m);
    [[nodiscard]] Vec3 point_at(const Eigen::VectorXd& x) const;
    /// external (3n) += the force on the point.
    void add_force(const Eigen::Vector3d& force_N, Eigen::VectorXd& external) const;

private:
    [[nodiscard]] Eigen::Matrix3d compliance_at(const Attachment& point, const RobotState& robot) const;
    [[nodiscard]] Eigen::Vector3d gap(const Eigen::VectorXd& x, const Eigen::Vector3d& force_N) const;

    const Equilibrium& system_;
    const FactoredLaplacian& laplacian_;
    double size_m_ = 1;
    std::optional<Pull> pull_;
    Eigen::Matrix3d compliance_ = Eigen::Matrix3d::Zero();  ///< m/N
    double spring_N_m_ = 0;
};

}  // namespace pliant::sim
