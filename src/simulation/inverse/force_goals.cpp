#include "simulation/inverse/force_goals.hpp"

#include "base/linalg/vectors.hpp"

namespace pliant::sim::inverse {
namespace {

constexpr Eigen::Index axes = 3;

/// The energy of contact changes with the place of an obstacle as with its nodes: what a motion of the obstacle does to
/// the forces on the robot is, by symmetry, what a motion of the robot does to the force on the obstacle.
std::vector<Quantity> contact_gradients(const Linearisation& at, const Goal& goal) {
    const Equilibrium& system = at.system();
    const contact::Contact& contact = *system.model().contact(true);
    std::vector<Quantity> all;
    for (Eigen::Index axis = 0; axis < axes; ++axis) {
        Eigen::VectorXd motion = Eigen::VectorXd::Zero(at.controls().obstacles.size());
        for (int node = contact.first_node(goal.on); node < contact.first_node(goal.on + 1); ++node)
            motion[3 * (node - contact.robot_node_count()) + axis] = 1;
        all.push_back({system.obstacle_stiffness_times(at.state(), at.controls(), motion),
                       Eigen::VectorXd::Zero(at.state().multiplier.size())});
    }
    return all;
}

/// Likewise with the nodes that a support holds.
std::vector<Quantity> support_gradients(Linearisation& at, const Goal& goal) {
    const Equilibrium& system = at.system();
    std::vector<Quantity> all;
    for (Eigen::Index axis = 0; axis < axes; ++axis) {
        Eigen::VectorXd motion = Eigen::VectorXd::Zero(at.state().x.size());
        for (const int node : system.model().description().supports[goal.on].nodes) motion[3 * node + axis] = 1;
        Quantity quantity{at.change_of(at.equations_of_motion(motion)).positions,
                          Eigen::VectorXd::Zero(at.state().multiplier.size())};
        for (std::size_t a = 0; a < system.actuators().size(); ++a) {
            Eigen::VectorXd force = Eigen::VectorXd::Zero(at.state().x.size());
            system.actuators()[a].add_gradient(linalg::view(at.state().x), 1, linalg::view(force),
                                               at.controls().shares[a]);
            quantity.by_multipliers[static_cast<Eigen::Index>(a)] = force.dot(motion);
        }
        all.push_back(std::move(quantity));
    }
    return all;
}

}  // namespace

Vec3 force_of(const Equilibrium& system, const State& state, const Controls& controls, const Evaluation& evaluation,
              const Goal& goal) {
    const Model& model = system.model();
    if (goal.kind == GoalKind::support_force)
        return model.held().reactions(model.description().supports, evaluation.out_of_balance)[goal.on];
    const contact::Forces forces = system.contact_forces(state, controls);
    if (goal.sum_of_sizes) return {norm(forces.on_robot_N[goal.on]), 0, 0};
    return forces.on_robot_N[goal.on];
}

std::vector<Quantity> force_gradients(Linearisation& at, const Goal& goal) {
    if (goal.kind == GoalKind::support_force) return support_gradients(at, goal);
    return contact_gradients(at, goal);
}

}  // namespace pliant::sim::inverse
