// What opening a job does not check: its pixels.
#pragma once

#include "printing/job/job.hpp"

namespace pliant::job {

/// Decodes every image: its area must be the manifest's, where `corrected` does not say that images hold greys
/// calibrated for a projector, and no two images of a layer may light the same pixel, unless the manifest says that
/// they share so much. Errors name archive, layer and
/// image.
[[nodiscard]] Status verify_images(const Archive& archive, bool corrected, const std::string& path);

}  // namespace pliant::job
