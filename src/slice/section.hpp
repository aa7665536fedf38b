// Plane sections of a closed surface.
#pragma once

#include <vector>

#include "slice/grid_surface.hpp"

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
    /// Takes the surface over. Cost: triangles times the blocks of layers that they cross.
    Sectioner(GridSurface surface, int layer_um);

    /// Layers [0, layer_count()) may have sections.
    [[nodiscard]] int layer_count() const { return layer_count_; }

    /// Appends the outline at the middle of `layer`. Safe to call from several threads.
    void section(int layer, std::vector<Segment>& segments) const;

private:
    [[nodiscard]] std::int64_t plane(int layer) const { return (2 * std::int64_t{layer} + 1) * half_layer_; }
    [[nodiscard]] int layers_below(std::int64_t z) const;
    void cut(const Triangle& t, std::int64_t plane, std::vector<Segment>& segments) const;

    GridSurface surface_;
    std::int64_t half_layer_;
    int layer_count_ = 0;
    std::vector<std::vector<int>> blocks_;  ///< triangles that may cross a plane of each block of layers
};

}  // namespace pliant::slice
