// Where a person wants supports and where none: painted on the part by hand, one touch of the brush after the other.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "printing/slice/body.hpp"
#include "printing/slice/layers.hpp"
#include "printing/slice/raster_frame.hpp"

namespace pliant::slice {

enum class SupportWish {
    usual,    ///< as angle and islands say; rubs out what was painted before
    enforce,  ///< tips, however steep it is
    block,    ///< no tip
};

/// One touch of the brush: what it says counts for the undersides inside a ball around a point of the surface. Where
/// touches overlap, the later one counts. A touch on a face that does not look down changes nothing: the ball may reach
/// through a thin wall to an underside that nobody has touched.
struct SupportTouch {
    SupportWish wish = SupportWish::enforce;
    Vec3 at_um;
    Vec3 normal;  ///< outward, of length 1
    double radius_um = 0;
};

/// Refuses numbers that are not finite, a normal without a length, and a radius that is not above 0 and at most 100 mm.
[[nodiscard]] Status check(const SupportTouch& touch);

/// Answers what is wanted at a pixel of an underside. Layers must outlive it.
class SupportPaint {
public:
    SupportPaint(std::span<const SupportTouch> touches, const Raster& raster, const Layers& layers);

    /// Nothing was painted on any face that looks down.
    [[nodiscard]] bool empty() const { return spots_.empty(); }
    /// Of the underside that layer `layer` shows at this pixel. Cost: a few spots.
    [[nodiscard]] SupportWish at(int layer, int row, int column) const;

    /// Pixels (row, column) in the middle of the touches that reach this layer from where they lie, in their order.
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
    int rows_, columns_;  ///< of cells
    std::vector<Spot> spots_;
    std::vector<std::vector<int>> cells_;  ///< (rows_ * columns_), spots in their order
};

}  // namespace pliant::slice
