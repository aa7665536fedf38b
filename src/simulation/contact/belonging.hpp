// Which surface features are one piece of skin, rather than two surfaces that may come into contact.
#pragma once

#include <span>
#include <vector>

#include "simulation/contact/surface.hpp"

namespace pliant::sim::contact {

/// Meshes have edges that nearly touch without sharing a node: the sides of a sliver, or bodies drawn flush. A force
/// that begins at half their distance would act over nanometres, a scale at which the surface has no meaning. Such
/// features belong together, as do those that share a node. Nearness is relative to the mesh size, the longest edge at
/// the nodes of the two features: 1/50 of it if they are joined by at most two edges of the surface, 1/10,000 of it
/// otherwise. Immutable.
class Belonging {
public:
    Belonging() = default;
    /// `positions`: (3 nodes) metres, at rest; features up to `touching_m` apart count as touching, whatever the mesh
    /// size.
    Belonging(const Surface& surface, std::span<const double> positions, double touching_m);

    /// `first`, `second`: the nodes of two features that are `apart_m` apart at rest. For nodes that are not on the
    /// surface (those of obstacles) only touching counts.
    [[nodiscard]] bool together(std::span<const int> first, std::span<const int> second, double apart_m) const;

private:
    [[nodiscard]] std::span<const int> neighbours(int node) const;
    [[nodiscard]] bool are_joined(int a, int b) const;

    double touching_m_ = 0;
    std::vector<std::size_t> first_neighbour_;  ///< (nodes + 1)
    std::vector<int> neighbours_;               ///< ascending for each node, including the node itself
    std::vector<double> longest_m_;             ///< (nodes) longest edge there
};

}  // namespace pliant::sim::contact
