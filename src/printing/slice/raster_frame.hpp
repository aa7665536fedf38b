// Where a place on the platform lies in the image.
#pragma once

#include <array>

#include "printing/slice/body.hpp"

namespace pliant::slice {

/// Turns platform coordinates into columns and rows: turn, move, mirror, in pixels. Exact for quarter turns.
class RasterFrame {
public:
    /// `um_per_unit`: of the coordinates that column() and row() are given.
    RasterFrame(const Raster& raster, double um_per_unit);

    [[nodiscard]] double column(double x, double y) const { return xx_ * x + xy_ * y + x0_; }
    [[nodiscard]] double row(double x, double y) const { return yx_ * x + yy_ * y + y0_; }
    /// The way back: x and y of a place in the image.
    [[nodiscard]] std::array<double, 2> place(double column, double row) const {
        const double c = column - x0_, r = row - y0_, det = xx_ * yy_ - xy_ * yx_;
        return {(yy_ * c - xy_ * r) / det, (xx_ * r - yx_ * c) / det};
    }
    /// Whether the image is seen from behind: left and right of an outline change places.
    [[nodiscard]] bool mirrored() const { return mirrored_; }

private:
    double xx_, xy_, x0_, yx_, yy_, y0_;
    bool mirrored_;
};

}  // namespace pliant::slice
