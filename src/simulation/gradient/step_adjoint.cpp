#include "simulation/gradient/step_adjoint.hpp"

#include "base/linalg/vectors.hpp"
#include "simulation/contact/contact.hpp"
#include "simulation/linearisation/contact_forces.hpp"

namespace pliant::sim {
namespace {

/// Obstacles are where their shares of a motion put them: adds what that is worth to the inputs.
void add_obstacles(const Linearisation& at, const Eigen::VectorXd& by_position, Eigen::VectorXd& by_inputs) {
    if (by_position.isZero(0) || by_inputs.size() == 0) return;
    const contact::Contact& contact = *at.system().model().contact(true);
    const std::vector<Parameter> all = inputs(at);
    for (std::size_t k = 0; k < all.size(); ++k) {
        if (all[k].kind != Parameter::Kind::obstacle_share) continue;
        const std::size_t obstacle = all[k].index;
        const Eigen::Vector3d move =
            linalg::vector(at.system().model().description().contact->obstacles[obstacle].move_m);
        for (int node = contact.first_node(obstacle); node < contact.first_node(obstacle + 1); ++node)
            by_inputs[static_cast<Eigen::Index>(k)] +=
                by_position.segment<3>(3 * static_cast<Eigen::Index>(node - contact.robot_node_count())).dot(move);
    }
}

/// In motion the velocity at the end of a step follows from where it ends, and forces from where it begins.
void carry_inertia(const Inertia& inertia, const Eigen::VectorXd& force_weights, Carried& carried) {
    const History by = inertia.start_weights(force_weights, carried.v);
    carried.x = carried.x_before + by.x;
    carried.v = carried.v_before + by.v;
    carried.x_before = by.x_before;
    carried.v_before = by.v_before;
}

void carry_nothing(Carried& carried) {
    carried.x.setZero();
    carried.v.setZero();
}

/// Friction slips from where the step begins.
void carry_friction(const Linearisation& at, const Eigen::VectorXd& force_weights, Carried& carried) {
    const Eigen::Index robot = at.state().x.size();
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(robot + at.controls().obstacles.size());
    weights.head(force_weights.size()) = force_weights;
    const Eigen::VectorXd by = friction_stiffness_times(at.system(), at.state(), at.controls(), weights);
    carried.x -= by.head(robot);
    carried.obstacles = -by.tail(by.size() - robot);
}

}  // namespace

Carried Carried::nothing(const Equilibrium& system) {
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(system.model().node_count()));
    return {none, none, none, none, Eigen::VectorXd::Zero(3 * obstacle_nodes(system))};
}

bool Carried::is_nothing() const {
    return x.isZero(0) && v.isZero(0) && x_before.isZero(0) && v_before.isZero(0) && obstacles.isZero(0);
}

Result<Variation> go_back_over(Linearisation& at, const Slope& own, const By& by, Carried& carried) {
    const auto& inertia = at.controls().inertia;
    Slope worth = own;
    worth.state.by_positions += carried.x;
    if (inertia) worth.state.by_positions += inertia->rate() * carried.v;
    const Result<Adjoint> adjoint = at.adjoint(worth.state);
    if (!adjoint) return tl::unexpected(adjoint.error());
    Variation result = gradient(at, *adjoint, worth, by);
    add_obstacles(at, carried.obstacles, result.inputs);
    const Eigen::VectorXd weights = at.force_weights(*adjoint);
    if (inertia)
        carry_inertia(*inertia, weights.head(at.state().x.size()), carried);
    else
        carry_nothing(carried);
    carry_friction(at, weights, carried);
    return result;
}

}  // namespace pliant::sim
