// Contact forces on the nodes of the robot and of the obstacles, and their derivatives.
//
// Contact has more nodes than the mesh: the surface points of objects, each carried by four nodes of the mesh, and the
// nodes of obstacles. Here forces are (3 robot nodes, then 3 obstacle nodes) or, with objects, (3 robot nodes, then 3
// obstacle nodes, then 3 obstacle nodes): the forces of obstacles on the robot, then those on objects. A motion has the
// same format; the last part may be missing if it equals the second.
#pragma once

#include <Eigen/Core>

#include "simulation/contact/friction.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// Number of obstacle nodes; 0 without contact.
[[nodiscard]] Eigen::Index obstacle_nodes(const Equilibrium& system);
/// Size of a force vector.
[[nodiscard]] Eigen::Index force_size(const Equilibrium& system);
/// (3 robot nodes, then 3 obstacle nodes): the total force on each obstacle node.
[[nodiscard]] Eigen::VectorXd force_on_places(const Equilibrium& system, const Eigen::VectorXd& forces);

/// Positions, or a motion, of all nodes of contact. `of_objects`: with the obstacle motion that applies to objects.
[[nodiscard]] std::vector<double> contact_nodes(const Equilibrium& system, const State& state,
                                                const Controls& controls);
[[nodiscard]] std::vector<double> contact_motion(const Equilibrium& system, const Eigen::VectorXd& motion,
                                                 bool of_objects);
/// The transpose: adds forces on contact's nodes to `forces`.
void add_contact_forces(const Equilibrium& system, std::span<const double> on_contact_nodes, bool of_objects,
                        Eigen::VectorXd& forces);
/// True if a point of an object is among the nodes of a pair.
[[nodiscard]] bool touches_object(const Equilibrium& system, std::span<const int> nodes);

/// Forces as they enter the out-of-balance force: minus the force on the node, so that those at an obstacle's nodes sum
/// to its force on the robot, or on objects. N.
struct ContactForces {
    Eigen::VectorXd pressure;  ///< normal forces between surfaces
    Eigen::VectorXd friction;  ///< as it is frozen in the controls; zero where there is none
};
[[nodiscard]] ContactForces contact_forces(const Equilibrium& system, const State& state, const Controls& controls);

/// The change of both with a motion, or of friction alone: symmetric matrices times `motion`, as forces. A motion of
/// the start of the step changes friction with the opposite sign.
[[nodiscard]] Eigen::VectorXd contact_stiffness_times(const Equilibrium& system, const State& state,
                                                      const Controls& controls, const Eigen::VectorXd& motion);
[[nodiscard]] Eigen::VectorXd friction_stiffness_times(const Equilibrium& system, const State& state,
                                                       const Controls& controls, const Eigen::VectorXd& motion);

}  // namespace pliant::sim
