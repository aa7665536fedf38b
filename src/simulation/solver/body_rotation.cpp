#include "simulation/solver/body_rotation.hpp"

#include "base/linalg/vectors.hpp"

namespace pliant::sim {
namespace {

using linalg::view;

}  // namespace

void BodyRotation::begin(const Eigen::VectorXd& x) {
    before_ = x;
    followed_.reset();
}

void BodyRotation::follow(const Eigen::VectorXd& x) {
    system_->model().elements().find_rotations(view(before_), view(x), rotations_);
    followed_ = std::make_shared<const Eigen::VectorXd>(x);
}

void BodyRotation::pull_back_forces(Eigen::MatrixXd& columns) const {
    if (!followed_) return;
    laplacian_->solve(columns);
    apply(Elements::Direction::back, columns);
}

void BodyRotation::push_forward_motions(Eigen::MatrixXd& columns) const {
    if (!followed_) return;
    apply(Elements::Direction::on, columns);
    laplacian_->solve(columns);
}

void BodyRotation::pull_back_step(Eigen::VectorXd& motion, Eigen::VectorXd& force) const {
    if (!followed_) return;
    Eigen::MatrixXd both(motion.size(), 2);  // the Laplacian solves for two at the cost of one
    both << motion, force;
    apply(Elements::Direction::back, both.leftCols(1));
    laplacian_->solve(both);
    apply(Elements::Direction::back, both.rightCols(1));
    motion = both.col(0);
    force = both.col(1);
}

/// columns <- G^T W R G columns, with held nodes fixed.
void BodyRotation::apply(Elements::Direction direction, Eigen::Ref<Eigen::MatrixXd> columns) const {
    Eigen::VectorXd motion(before_.size()), forces(before_.size());
    for (Eigen::Index k = 0; k < columns.cols(); ++k) {
        motion.setZero();
        forces.setZero();
        system_->add_free(columns.col(k), 1, motion);
        system_->model().elements().add_rotated(rotations_, direction, view(motion), view(forces));
        laplacian_->add_hold(motion, forces);
        columns.col(k) = system_->restrict_to_free(forces);
    }
}

}  // namespace pliant::sim
