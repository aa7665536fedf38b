// Plane sections of a closed surface.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "printing/slice/grid_surface.hpp"
#include "printing/slice/layers.hpp"

namespace pliant::slice {

/// A directed piece of outline, in grid units; the solid is on its left, seen from above.
struct Segment {
    double x0, y0, x1, y1;
};

/// Cuts one surface at the middle of layers. A point exactly on the plane counts as above it, so a plane never runs
/// along a face or through a corner. Each triangle with corners on both sides gives one segment; both triangles at an
/// edge compute its intersection from the same two points, so the segments of a closed surface form exactly closed
/// loops. A slab between the heights of two planes, with faces on the planes, appears in exactly one of them.
class Sectioner {
public:
    /// Takes ownership of the surface. Cost: triangles times the logarithm of the layers that each crosses.
    Sectioner(GridSurface surface, Layers layers);

    /// Layers [0, layer_count()) may have sections.
    [[nodiscard]] int layer_count() const { return layer_count_; }

    /// Appends the outline at the middle of `layer`. Thread-safe.
    void section(int layer, std::vector<Segment>& segments) const;

private:
    [[nodiscard]] std::int64_t plane(int layer) const {
        return std::int64_t{layers_.middle2_um(layer)} * grid_per_um / 2;
    }
    void cut(const Triangle& t, std::int64_t plane, std::vector<Segment>& segments) const;
    [[nodiscard]] std::pair<int, int> crossed(const Triangle& t) const;
    void plant_tree();

    GridSurface surface_;
    Layers layers_;
    int layer_count_ = 0;
    /// A segment tree over layers: node n covers the layers of nodes 2n and 2n + 1, the leaves are the nodes from
    /// leaves_ on. A triangle is listed at the fewest nodes that together cover the layers it crosses, so that a layer
    /// finds exactly its triangles on the path from its leaf to the root.
    std::size_t leaves_ = 1;
    std::vector<std::uint32_t> node_starts_;  ///< per node: start of its triangles in listed_
    std::vector<int> listed_;
};

}  // namespace pliant::slice
