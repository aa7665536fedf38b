// What the layer images of a job hold.
#pragma once

#include <vector>

#include "printing/job/job.hpp"

namespace pliant::job {

/// (materials) area times thickness over all images, mm³.
[[nodiscard]] std::vector<double> image_volumes_mm3(const Manifest& manifest);

}  // namespace pliant::job
