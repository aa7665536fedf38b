#include "simulation/run/live_pull.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "base/core/boxes.hpp"
#include "base/linalg/vectors.hpp"

namespace pliant::sim {
namespace {

constexpr double spring_stiffness = 8;   // relative to that of the body
constexpr double pull_share = 0.05;      // of the robot's size: motion of the point in one increment
constexpr double pull_tolerance = 2e-3;  // of the robot's size: tolerance of the spring's balance

bool same_point(const Attachment& a, const Attachment& b) {
    return a.nodes == b.nodes && a.weights == b.weights;
}

}  // namespace

PullSpring::PullSpring(const Equilibrium& system, const FactoredLaplacian& laplacian)
    : system_(system), laplacian_(laplacian) {
    size_m_ = bounds_of(system.model().mesh().points).diagonal();
}

bool PullSpring::take_up(const Pull& pull, const RobotState& robot) {
    if (pull_ && same_point(pull.point, pull_->point)) {
        pull_->handle_m = pull.handle_m;
        return false;
    }
    pull_ = pull;
    compliance_ = compliance_at(pull.point, robot);
    spring_N_m_ = 3 * spring_stiffness / std::max(compliance_.trace(), 1e-300);
    return true;
}

/// Displacement of a point per unit force on it, from the current tangent; m/N.
Eigen::Matrix3d PullSpring::compliance_at(const Attachment& point, const RobotState& robot) const {
    const Model& model = system_.model();
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(3 * model.free_count(), 3);
    for (std::size_t k = 0; k < point.nodes.size(); ++k) {
        const int free = model.free_index()[static_cast<std::size_t>(point.nodes[k])];
        if (free >= 0) columns.middleRows<3>(3 * free) += point.weights[k] * Eigen::Matrix3d::Identity();
    }
    const Eigen::MatrixXd forces = columns;
    const auto tangent = make_newton(system_, laplacian_);
    if (tangent->refresh(robot.now.state, robot.controls, TangentChoice::projected, {}))
        tangent->solve(columns);
    else
        laplacian_.solve(columns);
    const Eigen::Matrix3d compliance = forces.transpose() * columns;
    return 0.5 * (compliance + compliance.transpose());
}

Eigen::Vector3d PullSpring::balance(const Eigen::VectorXd& x, const Eigen::Vector3d& force_N) const {
    if (is_settled(x, force_N)) return force_N;
    const Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity() + spring_N_m_ * compliance_;
    return force_N + matrix.inverse() * gap(x, force_N);
}

bool PullSpring::is_settled(const Eigen::VectorXd& x, const Eigen::Vector3d& force_N) const {
    return gap(x, force_N).norm() <= pull_tolerance * size_m_ * spring_N_m_;
}

Eigen::Vector3d PullSpring::gap(const Eigen::VectorXd& x, const Eigen::Vector3d& force_N) const {
    return spring_N_m_ * linalg::vector(pull_->handle_m - point_at(x)) - force_N;
}

double PullSpring::distance(const Eigen::Vector3d& change_N) const {
    return (compliance_ * change_N).norm() / (pull_share * size_m_);
}

/// Broyden's rank-one update.
void PullSpring::learn(const Eigen::Vector3d& change_N, const Vec3& moved_m) {
    const Eigen::Matrix3d better = compliance_ + (linalg::vector(moved_m) - compliance_ * change_N) *
                                                     change_N.transpose() / change_N.squaredNorm();
    const Eigen::Matrix3d even = 0.5 * (better + better.transpose());
    if (Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(even).eigenvalues()[0] >= 0) compliance_ = even;
}

Vec3 PullSpring::point_at(const Eigen::VectorXd& x) const {
    return position(pull_->point, {x.data(), static_cast<std::size_t>(x.size())});
}

void PullSpring::add_force(const Eigen::Vector3d& force_N, Eigen::VectorXd& external) const {
    for (std::size_t k = 0; k < pull_->point.nodes.size(); ++k)
        external.segment<3>(3 * pull_->point.nodes[k]) += pull_->point.weights[k] * force_N;
}

}  // namespace pliant::sim
