#include "simulation/linearisation/contact_forces.hpp"

#include <vector>

#include "base/linalg/vectors.hpp"

namespace pliant::sim {
namespace {

using linalg::view;

/// Robot and obstacle nodes, as contact knows them.
Eigen::VectorXd positions(const State& state, const Controls& controls) {
    Eigen::VectorXd x(state.x.size() + controls.obstacles.size());
    x << state.x, controls.obstacles;
    return x;
}

/// Multiplies `motion` by the blocks that it is given.
contact::BlockVisitor multiplier(const Eigen::VectorXd& motion, Eigen::VectorXd& product) {
    return [&](int a, int b, const linalg::Matrix3& block) {
        product.segment<3>(3 * static_cast<Eigen::Index>(a)) +=
            block * motion.segment<3>(3 * static_cast<Eigen::Index>(b));
    };
}

}  // namespace

Eigen::Index obstacle_nodes(const Equilibrium& system) {
    const contact::Contact* contact = system.model().contact(true);
    return contact == nullptr ? 0 : contact->node_count() - contact->robot_node_count();
}

ContactForces contact_forces(const Equilibrium& system, const State& state, const Controls& controls) {
    const Eigen::VectorXd x = positions(state, controls);
    ContactForces forces{Eigen::VectorXd::Zero(x.size()), Eigen::VectorXd::Zero(x.size())};
    const contact::Contact* contact = system.model().contact(controls.met);
    if (contact == nullptr) return forces;
    contact->add_gradient(contact->find(view(x)), view(x), view(forces.pressure));
    if (controls.friction) controls.friction->add_gradient(view(x), view(forces.friction));
    return forces;
}

Eigen::VectorXd contact_stiffness_times(const Equilibrium& system, const State& state, const Controls& controls,
                                        const Eigen::VectorXd& motion) {
    Eigen::VectorXd product = friction_stiffness_times(system, state, controls, motion);
    const contact::Contact* contact = system.model().contact(controls.met);
    if (contact == nullptr) return product;
    const Eigen::VectorXd x = positions(state, controls);
    contact->visit_hessian(contact->find(view(x)), view(x), false, multiplier(motion, product));
    return product;
}

Eigen::VectorXd friction_stiffness_times(const Equilibrium& system, const State& state, const Controls& controls,
                                         const Eigen::VectorXd& motion) {
    Eigen::VectorXd product = Eigen::VectorXd::Zero(motion.size());
    if (system.model().contact(controls.met) == nullptr || !controls.friction) return product;
    const Eigen::VectorXd x = positions(state, controls);
    controls.friction->visit_hessian(view(x), multiplier(motion, product));
    return product;
}

}  // namespace pliant::sim
