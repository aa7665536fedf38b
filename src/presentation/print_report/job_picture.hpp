// What a job prints as one picture: the part from the front, layer by layer, and some of its layers.
#pragma once

#include <string>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"

namespace pliant::report {

/// A PNG file of 1600 x 1000 pixels. Materials have the colours of palette(), light of a pixel is its strength. Cost:
/// every image is decoded.
[[nodiscard]] Result<std::string> job_picture(const job::Archive& archive);

/// 24 of its layers from above, evenly from the platform up, in the same colours; the same size and cost.
[[nodiscard]] Result<std::string> layers_picture(const job::Archive& archive);

}  // namespace pliant::report
