// The slips of pairs that rub, two numbers for each: what derivatives of friction with memory (contact/friction.hpp)
// are made of, forwards and backwards.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulation/contact/friction.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// Along the tangents of each pair.
using Slips = std::vector<Eigen::Vector2d>;

/// How far a motion, in the numbers of contact_forces.hpp, takes the two features of each pair past each other.
[[nodiscard]] Slips slips_of_motion(const Equilibrium& system, const contact::Friction& friction,
                                    const Eigen::VectorXd& motion);

/// The transpose of that: adds to `forces`, in the same numbers.
void add_to_forces(const Equilibrium& system, const contact::Friction& friction, const Slips& slips,
                   Eigen::VectorXd& forces);

}  // namespace pliant::sim
