// The points of a surface in a tree of small regions that move nearly as one.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "base/core/box_tree.hpp"
#include "simulation/contact/surface.hpp"

namespace pliant::sim::contact {

/// The points of a surface, bisected along the longest side of their box until at most eight are left. Immutable.
class Regions {
public:
    struct Node {
        std::size_t begin, end;   ///< its points, in the order of points()
        std::size_t left, right;  ///< its halves; 0 in a leaf
        [[nodiscard]] bool is_leaf() const { return left == 0; }
    };

    Regions() = default;
    /// `positions`: (3 nodes) metres.
    Regions(const Surface& surface, std::span<const double> positions);

    /// Parents before their halves; the first is the root. Empty if the surface is.
    [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
    [[nodiscard]] const std::vector<int>& points() const { return points_; }
    [[nodiscard]] std::span<const int> points_of(const Node& node) const {
        return std::span(points_).subspan(node.begin, node.end - node.begin);
    }
    /// The leaf that contains a point of the surface.
    [[nodiscard]] std::size_t leaf_of(int point) const { return leaf_of_[static_cast<std::size_t>(point)]; }

    /// Three points of a leaf that are far apart and not collinear, at the positions given to the constructor; empty if
    /// there are none.
    [[nodiscard]] std::optional<std::array<int, 3>> corners(std::size_t leaf) const { return corners_[leaf]; }

    /// For each tree node, the bounding box of all triangles at its points.
    [[nodiscard]] std::vector<Bounds> boxes(const Surface& surface, std::span<const double> positions) const;
    /// For each tree node, the box of the displacements of its points from `from` to `x` and, unless `dx` is empty, to
    /// x + dx.
    [[nodiscard]] std::vector<Bounds> displacements(std::span<const double> from, std::span<const double> x,
                                                    std::span<const double> dx) const;

private:
    std::size_t split(std::span<const double> positions, std::size_t begin, std::size_t end);
    void add_up(std::vector<Bounds>& boxes) const;

    std::vector<int> points_;
    std::vector<Node> nodes_;
    std::vector<std::size_t> leaf_of_;                        ///< (nodes of the mesh)
    std::vector<std::optional<std::array<int, 3>>> corners_;  ///< (nodes)
};

}  // namespace pliant::sim::contact
