// The transformation from the platform to the image.
#pragma once

#include <array>

#include "printing/slice/body.hpp"

namespace pliant::slice {

/// Converts platform coordinates to columns and rows: rotation, translation, mirroring, in pixels. Exact for quarter
/// turns.
class RasterFrame {
public:
    /// `um_per_unit`: for the coordinates passed to column() and row().
    RasterFrame(const Raster& raster, double um_per_unit);

    [[nodiscard]] double column(double x, double y) const { return xx_ * x + xy_ * y + x0_; }
    [[nodiscard]] double row(double x, double y) const { return yx_ * x + yy_ * y + y0_; }
    /// The inverse: x and y of a point in the image.
    [[nodiscard]] std::array<double, 2> place(double column, double row) const {
        const double c = column - x0_, r = row - y0_, det = xx_ * yy_ - xy_ * yx_;
        return {(yy_ * c - xy_ * r) / det, (xx_ * r - yx_ * c) / det};
    }
    /// Whether the image is mirrored: left and right of an outline are swapped.
    [[nodiscard]] bool mirrored() const { return mirrored_; }

private:
    double xx_, xy_, x0_, yx_, yy_, y0_;
    bool mirrored_;
};

/// How far the image extends along x and y of the platform; of an image that is turned by no quarter turn, its bounding
/// box.
struct ImageExtent {
    double x_um = 0, y_um = 0;
};
[[nodiscard]] ImageExtent image_extent(const Raster& raster);

/// |cos| and |sin| of the image's rotation; exact for quarter turns.
[[nodiscard]] std::array<double, 2> turn_of(const Raster& raster);

}  // namespace pliant::slice
