// The light source: something that shows one frame after the other. A display, a folder, or a test double.
#pragma once

#include <functional>
#include <string>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"

namespace pliant::host {

class Panel {
public:
    virtual ~Panel() = default;
    [[nodiscard]] virtual int width_px() const = 0;
    [[nodiscard]] virtual int height_px() const = 0;
    [[nodiscard]] virtual double frame_s() const = 0;  ///< time between two frames
    /// Presents the next frame: `image`, which has the panel's size, or black if it is nullptr. Returns once the frame
    /// is on the panel, with that time in seconds since a fixed start. Successive calls are a frame apart.
    [[nodiscard]] virtual Result<double> present(const job::Image* image) = 0;
    /// To be called many times a second while nothing is presented. Error: the panel is gone.
    [[nodiscard]] virtual Status idle() { return {}; }
};

}  // namespace pliant::host
