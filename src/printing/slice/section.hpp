// Plane sections of a closed surface.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "printing/slice/grid_surface.hpp"
#include "printing/slice/layers.hpp"

namespace pliant::slice {

/// A directed piece of outline, in grid units; the solid lies on its left, seen from above.
struct Segment {
    double x0, y0, x1, y1;
};

/// Cuts one surface at the middle of layers. A point exactly on the plane counts as above it, so a plane never runs
/// along a face or through a corner: each triangle that has corners on both sides gives one segment, and since both
/// users of an edge compute its intersection from the same two points, the segments of a closed surface form closed
/// loops to the last bit. A slab between two planes' heights, faces on the planes, appears in exactly one of them.
class Sectioner {
public:
    /// Takes the surface over. Cost: triangles times the logarithm of the layers that each crosses.
    Sectioner(GridSurface surface, Layers layers);

    /// Layers [0, layer_count()) may have sections.
    [[nodiscard]] int layer_count() const { return layer_count_; }

    /// Appends the outline at the middle of `layer`. Safe to call from several threads.
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
    /// A segment tree over layers: node n covers those of nodes 2n and 2n + 1, the leaves are the nodes from leaves_
    /// on. A triangle is listed at the fewest nodes that together cover the layers that it crosses, so that a layer
    /// finds all its triangles, and no others, on the way from its leaf to the root.
    std::size_t leaves_ = 1;
    std::vector<std::uint32_t> node_starts_;  ///< per node: where its triangles begin in listed_
    std::vector<int> listed_;
};

}  // namespace pliant::slice
