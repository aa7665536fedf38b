// Pictures of a job: the part from the front, layer by layer, and some of its layers.
#pragma once

#include <string>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"

namespace pliant::report {

/// A PNG file of 1600 x 1000 pixels. Materials have their colours (material_colours.hpp), a pixel's brightness is its
/// grey value. Cost: every image is decoded.
[[nodiscard]] Result<std::string> job_picture(const job::Archive& archive);

/// 24 layers from above, evenly spaced from the platform up; same colours, size and cost.
[[nodiscard]] Result<std::string> layers_picture(const job::Archive& archive);

}  // namespace pliant::report
