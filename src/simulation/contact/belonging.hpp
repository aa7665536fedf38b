// Which features of a robot's surface are one piece of skin rather than two surfaces that may meet.
#pragma once

#include <span>
#include <vector>

#include "simulation/contact/surface.hpp"

namespace pliant::sim::contact {

/// Meshes have edges that nearly touch without sharing a node: the sides of a sliver, or bodies drawn flush. A force
/// that begins at half their distance would act over nanometres, and nothing that a surface does at that scale is
/// meant. Such features belong together, as those do that share a node. What is near is told by the mesh's own scale,
/// the longest edge at the nodes of the two features: a 50th of it where they are joined by at most two edges of the
/// surface, a 10,000th of it anywhere. Immutable.
class Belonging {
public:
    Belonging() = default;
    /// `positions`: (3 nodes) metres, at rest; features up to `touching_m` apart touch, whatever the mesh.
    Belonging(const Surface& surface, std::span<const double> positions, double touching_m);

    /// `first`, `second`: the nodes of two features that are `apart_m` apart at rest. Nodes that are not of the surface
    /// (those of obstacles) only ever touch.
    [[nodiscard]] bool together(std::span<const int> first, std::span<const int> second, double apart_m) const;

private:
    [[nodiscard]] std::span<const int> neighbours(int node) const;
    [[nodiscard]] bool are_joined(int a, int b) const;

    double touching_m_ = 0;
    std::vector<std::size_t> first_neighbour_;  ///< (nodes + 1)
    std::vector<int> neighbours_;               ///< ascending for each node, with the node itself
    std::vector<double> longest_m_;             ///< (nodes) longest edge there
};

}  // namespace pliant::sim::contact
