// Forces between what touches, on the nodes of the robot and on those of the obstacles, and how they change.
//
// Contact knows more nodes than the mesh: the points of objects, which four nodes of the mesh carry each, and the nodes
// of obstacles. Here forces are (3 robot nodes, then 3 obstacle nodes) or, where there are objects, (3 robot nodes,
// then 3 obstacle nodes, then 3 obstacle nodes): what an obstacle does to the robot, then what it does to objects. A
// motion has the same numbers, and may lack the last of them where they are those before.
#pragma once

#include <Eigen/Core>

#include "simulation/contact/friction.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// Nodes of the obstacles; 0 without contact.
[[nodiscard]] Eigen::Index obstacle_nodes(const Equilibrium& system);
/// How many numbers forces have.
[[nodiscard]] Eigen::Index force_size(const Equilibrium& system);
/// (3 robot nodes, then 3 obstacle nodes): what acts on an obstacle in all.
[[nodiscard]] Eigen::VectorXd force_on_places(const Equilibrium& system, const Eigen::VectorXd& forces);

/// All that contact knows: positions, or a motion, of its own nodes. `of_objects`: as pairs with objects see it.
[[nodiscard]] std::vector<double> contact_nodes(const Equilibrium& system, const State& state,
                                                const Controls& controls);
[[nodiscard]] std::vector<double> contact_motion(const Equilibrium& system, const Eigen::VectorXd& motion,
                                                 bool of_objects);
/// Its transpose: adds forces on contact's nodes to `forces`.
void add_contact_forces(const Equilibrium& system, std::span<const double> on_contact_nodes, bool of_objects,
                        Eigen::VectorXd& forces);
/// Whether a point of an object is among the nodes of a pair.
[[nodiscard]] bool touches_object(const Equilibrium& system, std::span<const int> nodes);

/// Forces as they enter the out-of-balance force: minus what acts on the node, so that those of an obstacle's nodes add
/// up to what it does to the robot, or to objects. N.
struct ContactForces {
    Eigen::VectorXd pressure;  ///< of the surfaces on each other
    Eigen::VectorXd friction;  ///< as it is frozen in the controls; zero where there is none
};
[[nodiscard]] ContactForces contact_forces(const Equilibrium& system, const State& state, const Controls& controls);

/// The change of both together with a motion, or of friction alone: symmetric matrices times `motion`, as forces. Where
/// the step begins moves friction the other way.
[[nodiscard]] Eigen::VectorXd contact_stiffness_times(const Equilibrium& system, const State& state,
                                                      const Controls& controls, const Eigen::VectorXd& motion);
[[nodiscard]] Eigen::VectorXd friction_stiffness_times(const Equilibrium& system, const State& state,
                                                       const Controls& controls, const Eigen::VectorXd& motion);

}  // namespace pliant::sim
