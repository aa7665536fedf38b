// The slips of pairs in frictional contact, two numbers for each. Derivatives of friction with memory
// (contact/friction.hpp) are formed from them, forwards and backwards.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulation/contact/friction.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// Slips along the tangents of each pair.
using Slips = std::vector<Eigen::Vector2d>;

/// Relative motion of the two features of each pair along its tangents, for a motion in the format of
/// contact_forces.hpp.
[[nodiscard]] Slips slips_of_motion(const Equilibrium& system, const contact::Friction& friction,
                                    const Eigen::VectorXd& motion);

/// The transpose of that: adds to `forces`, in the same format.
void add_to_forces(const Equilibrium& system, const contact::Friction& friction, const Slips& slips,
                   Eigen::VectorXd& forces);

}  // namespace pliant::sim
