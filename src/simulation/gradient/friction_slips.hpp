// The slips of pairs that rub, two numbers for each: what derivatives of friction with memory (contact/friction.hpp)
// are made of, forwards and backwards.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulation/contact/friction.hpp"

namespace pliant::sim {

/// Along the tangents of each pair.
using Slips = std::vector<Eigen::Vector2d>;

/// How far a motion (3 robot nodes, then 3 obstacle nodes) takes the two features of a pair past each other.
[[nodiscard]] Eigen::Vector2d slip_of_motion(const contact::FrozenPair& pair, const Eigen::VectorXd& motion);

/// The transpose of that, of all pairs: adds to `nodes` (3 robot nodes, then 3 obstacle nodes).
void add_to_nodes(const contact::Friction& friction, const Slips& slips, Eigen::VectorXd& nodes);

}  // namespace pliant::sim
