// Where the platform ends: what is beside it has nothing to hang on.
#pragma once

#include <optional>
#include <string>

#include "base/core/error.hpp"
#include "printing/slice/body.hpp"
#include "printing/slice/raster_frame.hpp"
#include "printing/slice/run_image.hpp"

namespace pliant::job {

/// How far something lies beyond the platform, and on which side.
struct Beyond {
    double um = 0;  ///< 0: it is on the platform
    char axis = 'x';
    bool negative = false;  ///< on the side of the lower coordinates

    void merge(const Beyond& other) {
        if (other.um > um) *this = other;
    }
};

class PlatformEdge {
public:
    /// `width_um`, `depth_um`: of the platform, in the middle of the image; 0 if not known, then it has no edge.
    PlatformEdge(const slice::Raster& raster, double width_um, double depth_um);

    /// The room for parts: of the image, or of the platform where it is smaller.
    [[nodiscard]] double width_um() const { return width_um_; }
    [[nodiscard]] double depth_um() const { return depth_um_; }
    /// Whether the platform limits it.
    [[nodiscard]] bool limits() const { return limits_; }

    /// Of a body's bounds; rounding errors are none.
    [[nodiscard]] Beyond beyond(const Box3& box_um) const;
    /// Of the pixels [begin, end) of a row of an image. A pixel may reach over the edge, and outlines that were moved
    /// by less than a pixel.
    [[nodiscard]] Beyond beyond(int row, int begin, int end) const;
    [[nodiscard]] Beyond beyond(const slice::RunImage& image) const;

    /// "lies 4.800 mm beyond the platform at +y, which reaches from -76.200 to 76.200 mm there".
    [[nodiscard]] std::string text(const Beyond& beyond) const;

private:
    [[nodiscard]] Beyond beyond_place(double x_um, double y_um, double slack_um) const;

    double half_x_um_, half_y_um_, width_um_, depth_um_, pixel_um_;  ///< halves: 0 if not known
    bool limits_;
    slice::RasterFrame frame_;
};

/// Errors: the body, or what it was repeated to, does not stand on the platform.
[[nodiscard]] Status check_on_platform(const PlatformEdge& edge, const Box3& box_um, const std::string& label);

}  // namespace pliant::job
