// A spring between a point of the body and a handle: the force with which both are in balance.
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

/// The spring is so much stiffer than the body that the point follows the handle most of the way. How the body gives
/// way there is learnt as it moves.
class PullSpring {
public:
    /// Both must outlive it.
    PullSpring(const Equilibrium& system, const FactoredLaplacian& laplacian);

    void let_go() { pull_.reset(); }
    /// True if `pull` takes hold of another point than before, so that the force on the last one is gone.
    bool take_up(const Pull& pull, const RobotState& robot);
    [[nodiscard]] const std::optional<Pull>& pull() const { return pull_; }

    /// The force at which the spring and the body are in balance, as far as is known; `force_N` acts now.
    [[nodiscard]] Eigen::Vector3d balance(const Eigen::VectorXd& x, const Eigen::Vector3d& force_N) const;
    [[nodiscard]] bool is_settled(const Eigen::VectorXd& x, const Eigen::Vector3d& force_N) const;
    /// How far a change of the force moves the point, in pieces that are usually solved at once.
    [[nodiscard]] double distance(const Eigen::Vector3d& change_N) const;

    /// What a change of the force alone has moved.
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
