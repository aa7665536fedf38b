// Hand-painted support regions: where supports are wanted or forbidden, as a list of brush strokes.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "printing/slice/body.hpp"
#include "printing/slice/layers.hpp"
#include "printing/slice/raster_frame.hpp"

namespace pliant::slice {

enum class SupportWish {
    usual,    ///< as angle and islands say; erases earlier paint
    enforce,  ///< tips, whatever the angle
    block,    ///< no tip
};

/// One brush stroke: applies to the undersides inside a ball around a point of the surface. Where strokes overlap, the
/// later one counts. A stroke on a face that does not look down changes nothing, because the ball may reach through a
/// thin wall to an underside that was not painted.
struct SupportTouch {
    SupportWish wish = SupportWish::enforce;
    Vec3 at_um;
    Vec3 normal;  ///< outward unit normal
    double radius_um = 0;
};

/// Errors: numbers that are not finite, a zero normal, a radius outside (0, 100] mm.
[[nodiscard]] Status check(const SupportTouch& touch);

/// Looks up the painted wish at a pixel of an underside. Layers must outlive it.
class SupportPaint {
public:
    SupportPaint(std::span<const SupportTouch> touches, const Raster& raster, const Layers& layers);

    /// No face that looks down was painted.
    [[nodiscard]] bool empty() const { return spots_.empty(); }
    /// For the underside that layer `layer` shows at this pixel. Cost: a few spots.
    [[nodiscard]] SupportWish at(int layer, int row, int column) const;

    /// Pixels (row, column) at the centres of the strokes that reach this layer, in order.
    [[nodiscard]] std::vector<std::pair<int, int>> middles(int layer) const;

private:
    struct Spot {
        SupportWish wish;
        double row, column, z_um, radius_um;
    };
    [[nodiscard]] int cell_row(double row) const;
    [[nodiscard]] int cell_column(double column) const;

    const Layers& layers_;
    double pixel_um_;
    int rows_, columns_;  ///< number of cells
    std::vector<Spot> spots_;
    std::vector<std::vector<int>> cells_;  ///< (rows_ * columns_) spots of each cell, in order
};

}  // namespace pliant::slice
