// The parts of a layer's outlines that stay apart from each other.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "printing/slice/section.hpp"

namespace pliant::slice {

/// A piece of outline from its lower end to its upper one.
struct Edge {
    double y0, y1, x0, x1;
    int body, winding;  ///< `winding`: change of the winding number from left to right

    [[nodiscard]] double at(double y) const {
        return y <= y0 ? x0 : y >= y1 ? x1 : x0 + (x1 - x0) * (y - y0) / (y1 - y0);
    }
};

/// Bodies with a winding number other than zero, in ascending order.
using Windings = std::vector<std::pair<int, int>>;

/// Across an edge, from left to right.
void pass(Windings& inside, const Edge& edge);

/// Edges that may cross or touch each other, and what surrounds them: no edge of another cluster comes near, so that
/// the winding numbers around it are the same everywhere.
struct Cluster {
    std::vector<Edge> edges;  ///< by their lower ends
    Windings around;          ///< due to the outlines of other clusters
};

/// The clusters of a layer: pieces of outline whose boxes touch are of the same one. `outlines` per body: closed, with
/// exactly shared corners. Level pieces hold together what is at their ends, and are left out.
[[nodiscard]] std::vector<Cluster> clusters_of(std::span<const std::vector<Segment>> outlines);

}  // namespace pliant::slice
